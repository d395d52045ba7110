#!/usr/bin/env python3
"""Plays patterns to the channel of machine/dram.py, which looks at every waiting request in every cycle, and prints rows.

    dram_scan.py [--only WORD]

The columns are those of tests/data/dram-ramulator21.csv; `cycles` is the cycle in which the last read took a place. The
rows stand in tests/data/dram-scan.csv, with patterns that the rows of Ramulator do not have: short strips and hot rows."""
import argparse

from dram_rows import BEGIN, PRESETS, BANKS, GROUPS, addresses
from machine.dram import NEVER, PRESETS as TIMES, Request, channel_of

READS = 4000
PATTERNS = "strip_64", "strip_128", "strip_256", "strip_512", "hot_70"
ALL = [(standard, pattern, places, refresh, gap) for standard in PRESETS for pattern in PATTERNS
       for places, refresh, gap in ((32, 0, 1), (128, 1, 1), (128, 0, 1), (32, 1, 6))]


def place_of(standard, address):
    _, pseudo, columns = PRESETS[standard]
    rest, p = divmod(address // 32 // columns, pseudo)
    rest, group = divmod(rest, GROUPS)
    row, bank = divmod(rest, BANKS)
    return (p * GROUPS + group) * BANKS + bank, row


class Counted(Request):
    """How it met its row is told by the first command that it needs."""

    def __init__(self, bank, row):
        super().__init__(bank, row, False, None)
        self.taken, self.met = None, None


def play(standard, pattern, places, refresh, gap):
    preset = PRESETS[standard][0]
    times = dict(TIMES[preset])
    if not refresh:
        times["refi"] = NEVER
    channel = channel_of(preset, times, places)
    waiting = [(BEGIN + i * gap, Counted(*place_of(standard, a))) for i, a in enumerate(addresses(standard, pattern, READS))]
    channel.arrivals[0].extend(waiting)
    counts = {"hit": 0, "miss": 0, "conflict": 0}
    change_row = channel.change_row

    def counted(request, queue, now):
        if request.met is None:
            request.met = "miss" if channel.banks[request.bank].row is None else "conflict"
            counts[request.met] += 1
        change_row(request, queue, now)
    channel.change_row = counted
    now, latencies, last, left = 0, 0, 0, READS
    while left:
        before = len(channel.arrivals[0])
        served = channel.step(now)
        if len(channel.arrivals[0]) < before:
            waiting[READS - before][1].taken = last = now
        if served:
            left -= 1
            latencies += served[1] - served[0].taken
            counts["hit"] += served[0].met is None
        now += 1
    return last - BEGIN, counts, latencies / READS


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="")
    only = parser.parse_args().only
    print("standard,pattern,queue,refresh,gap_cycles,reads,cycles,row_hits,row_misses,row_conflicts,avg_read_latency_cycles")
    for row in ALL:
        name = ",".join(map(str, row))
        if only not in name:
            continue
        cycles, counts, latency = play(*row)
        print(f"{name},{READS},{cycles},{counts['hit']},{counts['miss']},{counts['conflict']},{latency:.6f}", flush=True)


if __name__ == "__main__":
    main()
