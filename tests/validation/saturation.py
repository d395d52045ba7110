#!/usr/bin/env python3
"""Use of the links of saturated networks with several ways out of a source, with one source queue and with one a direction.

    saturation.py CAROUSEL [PACKETS]

Prints a table for docs/internals/validation.md. Exit status 1 if the packets delivered needed more than the links
can move."""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
CONFIG = HERE.parent.parent / "configs" / "traffic.yaml"
NETWORKS = [("bidirectional", 8, 1), ("bidirectional", 16, 1), ("bidirectional", 32, 1),
            ("multi_ring", 16, 2), ("multi_ring", 32, 2), ("multi_ring", 32, 4)]


def use_of_links(carousel, packets, shape, k, rings, flow, queues):
    """Part of all links' time that the packets delivered needed. The mix of packets does not matter to it: with queues of
    their own, packets that stay at their source are all accepted, however full the links are."""
    values = {"topology.shape": shape, "topology.resources": k, "topology.rings": rings, "topology.flow": flow,
              "topology.link.depth": 16, "workload.traffic.rate": 1.0, "workload.traffic.packets": packets,
              "workload.traffic.source_queues": queues}
    sets = [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    run = subprocess.run([carousel, "run", CONFIG, "--json", "--force", "--out", "out/validate", *sets], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)["traffic"]["accepted_of_links"]


def main():
    carousel = sys.argv[1]
    packets = int(sys.argv[2]) if len(sys.argv) > 2 else 400000
    print("| network | k | shared, bubble | shared, credits | per_direction, bubble | per_direction, credits |")
    print("|---|---:|---:|---:|---:|---:|")
    bad = 0
    for shape, k, rings in NETWORKS:
        parts = [use_of_links(carousel, packets, shape, k, rings, flow, queues)
                 for queues in ("shared", "per_direction") for flow in ("bubble", "credits")]
        bad += any(part > 1.005 for part in parts)  # some packets delivered were on their way when the window began
        name = shape if shape == "bidirectional" else f"{shape}, {rings} rings"
        print(f"| {name} | {k} | " + " | ".join(f"{100 * part:.1f} %" for part in parts) + " |", flush=True)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
