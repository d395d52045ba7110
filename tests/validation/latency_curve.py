#!/usr/bin/env python3
"""Latency against load of the one-way ring: Carousel and the independent SimPy model beside it.

    latency_curve.py CAROUSEL [PACKETS]

Prints a table for docs/internals/validation.md. Exit status 1 if a point of the two differs by more than the confidence
intervals of both and 0.2 % of the latency."""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
CONFIG = HERE.parent.parent / "configs" / "traffic.yaml"
POINTS = [(8, 16, 0.02), (8, 16, 0.1), (8, 16, 0.15), (8, 16, 0.2), (8, 16, 0.24), (8, 4, 0.08), (16, 16, 0.06), (16, 16, 0.1)]


def ours(carousel, resources, depth, rate):
    values = {"topology.resources": resources, "topology.link.depth": depth, "workload.traffic.rate": rate}
    sets = [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    run = subprocess.run([carousel, "run", CONFIG, "--json", "--force", "--out", "out/validate", *sets], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)["traffic"]


def simpy(resources, depth, rate, packets):
    command = [sys.executable, HERE / "simpy_ring.py", resources, depth, rate, packets, 1]
    return map(float, subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout.split())


def main():
    carousel = sys.argv[1]
    packets = int(sys.argv[2]) if len(sys.argv) > 2 else 40000
    print("| resources | depth | load | closed form, alone | Carousel | SimPy at this R | 99 % interval | difference |")
    print("|---:|---:|---:|---:|---:|---:|---:|---:|")
    bad = 0
    for resources, depth, rate in POINTS:
        here = ours(carousel, resources, depth, rate)
        mean = here["latency"]["mean"]
        theirs, half_width, routers = simpy(resources, depth, rate, packets)
        theirs += 4 * (here["routers_mean"] - routers)  # how far packets had to go is chance
        # Ours has 1,000,000 packets; as if its interval were as wide as that of so many of SimPy's.
        tolerance = half_width * (1 + (packets / 1e6) ** 0.5) + 0.002 * theirs
        bad += abs(mean - theirs) > tolerance
        print(f"| {resources} | {depth} | {rate} | {here['zero_load_latency']:.3f} | {mean:.3f} | {theirs:.3f} | "
              f"± {half_width:.3f} | {100 * (mean / theirs - 1):+.2f} % |", flush=True)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
