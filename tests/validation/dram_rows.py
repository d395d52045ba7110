#!/usr/bin/env python3
"""Compares DRAM with banks, run alone by `carousel run` (workload: {memory_trace: FILE}), with rows of Ramulator 2.1.

    dram_rows.py CAROUSEL [--rows FILE.csv] [--only WORD] [--write docs/internals/data/dram-rows.md]

A row is standard, pattern, queue, refresh, gap_cycles, reads, cycles, row_hits, row_misses, row_conflicts,
avg_read_latency_cycles. Ends with status 1 if a row with 32 places or more is off by more than 1 % in cycles or 2.5 % in
latency, or their medians by more than 0.1 and 0.5 %. --write puts the table into a page, between its marks."""
import argparse
import csv
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

PRESETS = {"GDDR6": ("gddr6_14", 1, 64), "HBM2": ("hbm2_2", 2, 32), "LPDDR5": ("lpddr5_6400", 1, 64)}
GROUPS = BANKS = 4
ROWS = {"GDDR6": 16384, "HBM2": 16384, "LPDDR5": 32768}
BEGIN = 1  # Ramulator's clock shows 1 in its first cycle, and its first refresh is due when it shows nREFI
MARKS = "<!-- dram_rows.py begins -->\n", "<!-- dram_rows.py ends -->\n"


def addresses(standard, pattern, reads):
    """Of one channel with mapping: row_bank_group_column."""
    _, pseudo, columns = PRESETS[standard]
    def place(p, group, bank, row, column):
        return 32 * ((((row * BANKS + bank) * GROUPS + group) * pseudo + p) * columns + column)
    if pattern == "sequential":
        for i in range(reads):
            rest, p = divmod(i, pseudo)
            rest, group = divmod(rest, GROUPS)
            rest, column = divmod(rest, columns)
            row, bank = divmod(rest, BANKS)
            yield place(p, group, bank, row, column)
        return
    x = 1

    def draw(n):
        nonlocal x
        x = (6364136223846793005 * x + 1442695040888963407) % 2**64
        return (x >> 33) % n
    hot = pattern == "hot_70"
    unit = 8 if hot else int(pattern.split("_")[1]) // 32
    made = 0
    while made < reads:
        near = hot and draw(10) < 7
        if standard == "LPDDR5":
            draw(1)  # the rank: a standard with ranks draws it, also if there is one
        p = draw(pseudo) if pseudo > 1 else 0
        group, bank, row = draw(GROUPS), draw(BANKS), draw(4 if near else ROWS[standard])
        column = draw(columns // unit) * unit
        for i in range(min(unit, reads - made)):
            yield place(p, group, bank, row, column + i)
        made += unit


def simulate(carousel, row, folder):
    """The cycle in which the last read took a place, the mean latency, and how rows were met. DRAM and engine have the
    same clock, so that the engine's cycles are DRAM's."""
    preset, gap = PRESETS[row["standard"]][0], int(row["gap_cycles"])
    lines = ["cycle,kind,address,bytes"]
    lines += [f"{BEGIN + i * gap},read,{a},32"
              for i, a in enumerate(addresses(row["standard"], row["pattern"], int(row["reads"])))]
    (folder / "trace.csv").write_text("\n".join(lines) + "\n")
    dram = {"preset": preset, "channels": 1, "period_ps": 1000, "mapping": "row_bank_group_column",
            "queue": int(row["queue"]), "refresh": row["refresh"] == "1"}
    (folder / "alone.yaml").write_text(json.dumps({"engine": {"kind": "cycle", "clock_mhz": 1000},
                                                   "workload": {"memory_trace": "trace.csv"}, "memory": {"dram": dram}}))
    subprocess.run([carousel, "run", folder / "alone.yaml", "--out", folder / "out", "--force", "--quiet", "--no-html"],
                   check=True)
    trace = json.loads((folder / "out/report.json").read_text())["memory_trace"]
    channel = trace["dram"]["channels"][0]
    return trace["last_taken_cycle"] - BEGIN, channel["latency"]["mean"], channel


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("carousel", type=Path)
    parser.add_argument("--rows", type=Path, default=Path(__file__).parents[1] / "data/dram-ramulator21.csv")
    parser.add_argument("--only", default="")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    table = ["| DRAM | pattern | places | refresh | a read every | cycles, Ramulator 2.1 | here | | mean latency, Ramulator 2.1 | here | |",
             "|---|---|---:|---|---:|---:|---:|---:|---:|---:|---:|"]
    errors = []
    with tempfile.TemporaryDirectory() as folder:
        for row in csv.DictReader(arguments.rows.open()):
            if arguments.only not in ",".join(row.values()):
                continue
            cycles, latency, _ = simulate(arguments.carousel.resolve(), row, Path(folder))
            latency += 1  # Ramulator counts a cycle more than nCL + nBL
            off = cycles / float(row["cycles"]) - 1, latency / float(row["avg_read_latency_cycles"]) - 1
            if int(row["queue"]) >= 32:
                errors.append(off)
            table.append(f"| {row['standard']} | {row['pattern']} | {row['queue']} | {'on' if row['refresh'] == '1' else 'off'} | "
                         f"{row['gap_cycles']} | {row['cycles']} | {cycles} | {100 * off[0]:+.2f} % | "
                         f"{row['avg_read_latency_cycles']} | {latency:.2f} | {100 * off[1]:+.2f} % |")
    if not errors:
        sys.exit("no row has 32 places or more")
    worst = [max(abs(e[i]) for e in errors) for i in (0, 1)]
    median = [statistics.median(abs(e[i]) for e in errors) for i in (0, 1)]
    said = (f"{len(errors)} rows with 32 places or more: cycles off by {100 * worst[0]:.2f} % at most and "
            f"{100 * median[0]:.2f} % in the median, mean latency by {100 * worst[1]:.2f} % and {100 * median[1]:.2f} %.")
    print("\n".join(table) + "\n\n" + said)
    if arguments.write:
        before, rest = arguments.write.read_text().split(MARKS[0])
        after = rest.split(MARKS[1])[1]
        arguments.write.write_text(before + MARKS[0] + said + "\n\n" + "\n".join(table) + "\n" + MARKS[1] + after)
    return int(worst[0] > 0.01 or worst[1] > 0.025 or median[0] > 0.001 or median[1] > 0.005)


if __name__ == "__main__":
    sys.exit(main())
