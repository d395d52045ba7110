"""Networks drawn at random against closed forms that are counted here, with nothing of the program: the cycles of lone
packets, the mean way, and the load that fills the busiest link. CAROUSEL names the program, CAROUSEL_SEED the first graph,
and CAROUSEL_EFFORT how many."""

import heapq
import json
import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

GRAPHS = max(4, round(20 * float(os.environ.get("CAROUSEL_EFFORT", 1))))
PAIRS = 4
BYTES = 32  # of a link in most graphs


class Drawing:
    """A connected graph of 6 to 40 nodes, some of them routers, with links both ways of many latencies. Every third has
    links of several widths and routers that store packets whole."""

    def __init__(self, seed):
        draw = random.Random(seed)
        count = draw.randint(6, 40)
        self.resources = count - draw.randint(0, count // 3)
        self.mixed = seed % 3 == 0
        self.links = {}  # by ends: latency, bytes a cycle
        pairs = [(draw.randrange(i), i) for i in range(1, count)]
        pairs += [tuple(draw.sample(range(count), 2)) for _ in range(draw.randint(1, count))]
        for a, b in pairs:
            if (a, b) not in self.links:
                one = draw.randint(1, 9), draw.choice((8, 16, 32, 64)) if self.mixed else BYTES
                self.links[a, b] = self.links[b, a] = one
        self.cycles = [draw.randint(0, 3) for _ in range(count)]
        self.whole = [self.mixed and i >= self.resources and draw.random() < 0.5 for i in range(count)]
        self.channels, self.depth = draw.randint(1, 8), draw.randint(1, 16)
        self.inject, self.eject = draw.randint(0, 4), draw.randint(0, 4)
        self.bytes = draw.choice((8, 32, 64, 100, 160))
        self.ways = [self.first_links(start) for start in range(count)]
        self.some = [draw.sample(range(self.resources), 2) for _ in range(PAIRS)]

    def name(self, node):
        return f"r[{node}]" if node < self.resources else f"x{node}"

    def text(self):
        lines = ["engine: {kind: cycle}", "topology:", "  shape: graph",
                 f"  link: {{depth: {self.depth}, virtual_channels: {self.channels}}}", "  nodes:"]
        # Nodes of a group are alike, so the resources take what the first has.
        lines.append(f"    - {{name: r, count: {self.resources}, latency_cycles: {self.cycles[0]}}}")
        for node in range(self.resources, len(self.cycles)):
            forward = "whole" if self.whole[node] else "head"
            lines.append(f"    - {{name: x{node}, kind: router, latency_cycles: {self.cycles[node]}, forward: {forward}}}")
        lines.append("  links:")
        for (a, b), (latency, width) in self.links.items():
            lines.append(f"    - {{from: '{self.name(a)}', to: '{self.name(b)}', latency_cycles: {latency}, "
                         f"bytes_per_cycle: {width}}}")
        return "\n".join(lines) + "\n"

    def node_cycles(self, node):
        return self.cycles[0 if node < self.resources else node]

    def first_links(self, start):
        """By destination: the node after `start` on the shortest way. A node is reached by the neighbour that is nearest
        to the start, and of equally near ones by that with the lowest number."""
        distance, first, done, queue = {start: 0}, {}, set(), [(0, start)]
        while queue:
            so_far, at = heapq.heappop(queue)
            if at in done:
                continue
            done.add(at)
            for (a, b), (latency, _) in sorted(self.links.items()):
                if a == at and (b not in distance or so_far + latency < distance[b]):
                    distance[b] = so_far + latency
                    first[b] = b if at == start else first[at]
                    heapq.heappush(queue, (distance[b], b))
        return first

    def way(self, start, end):
        out = []
        while start != end:
            out.append((start, self.ways[start][end]))
            start = out[-1][1]
        return out

    def way_cycles(self, start, end):
        return sum(self.node_cycles(link[0]) + self.links[link][0] for link in self.way(start, end))

    def alone(self, start, end):
        """The cycles of a packet that meets no other. It is stored whole where the width changes, and where a router says."""
        way = self.way(start, end)
        flits = [-(-self.bytes // self.links[link][1]) for link in way]
        stored = 0
        for i, link in enumerate(way):
            last = i + 1 == len(way)
            if last or self.whole[link[1]] or self.links[way[i + 1]][1] != self.links[link][1]:
                stored += flits[i] - 1
        return self.inject + self.way_cycles(start, end) + stored + self.eject

    def loads(self):
        """Ways over each link for its width in flits of BYTES, between all pairs."""
        loads = dict.fromkeys(self.links, 0)
        for start in range(self.resources):
            for end in range(self.resources):
                for link in self.way(start, end):
                    loads[link] += BYTES / self.links[link][1]
        return loads


class DrawnGraphs(unittest.TestCase):
    def run_program(self, *words):
        done = subprocess.run([os.environ["CAROUSEL"], *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def check_ways(self, drawing, file):
        printed = subprocess.run([os.environ["CAROUSEL"], "check", file], capture_output=True, text=True, check=False).stdout
        pairs = [(a, b) for a in range(drawing.resources) for b in range(drawing.resources)]
        cycles = sum(drawing.way_cycles(a, b) for a, b in pairs) / len(pairs)
        nodes = sum(1 + len(drawing.way(a, b)) for a, b in pairs) / len(pairs)
        self.assertIn(f"# ways: {cycles:.4f} cycles and {nodes:.4f} nodes on average, ", printed)
        bound = drawing.resources / max(drawing.loads().values())
        found = float(re.search(r"fills it at ([0-9.]+) flits", printed)[1])
        self.assertAlmostEqual(found, bound, delta=1e-4)
        return bound

    def test_lone_packets_take_the_shortest_way(self):
        first = int(os.environ.get("CAROUSEL_SEED", 1)) * 1000
        for seed in range(first, first + GRAPHS):
            drawing = Drawing(seed)
            with self.subTest(seed=seed), tempfile.TemporaryDirectory() as folder:
                file = str(Path(folder) / "graph.yaml")
                traffic = (f"inject_cycles: {drawing.inject}, eject_cycles: {drawing.eject}, packet_bytes: {drawing.bytes}")
                Path(file).write_text(drawing.text() + f"workload: {{traffic: {{{traffic}, rate: 0.001, packets: 200}}}}\n")
                bound = self.check_ways(drawing, file)
                for start, end in drawing.some:
                    sets = [f"workload.traffic.sources={drawing.name(start)}",
                            f"workload.traffic.destinations={drawing.name(end)}"]
                    words = [word for one in sets for word in ("--set", one)]
                    report = json.loads(self.run_program("run", file, "--json", "--force", *words))
                    # Two packets that are drawn a few cycles apart may meet, so the least is compared exactly.
                    self.assertEqual(report["traffic"]["least_latency"], drawing.alone(start, end))
                    self.assertAlmostEqual(report["traffic"]["latency"]["mean"] / drawing.alone(start, end), 1, delta=0.01)
                # Half of what fills the busiest link gets through, with channels enough.
                flits = -(-drawing.bytes // BYTES)
                loaded = [f"workload.traffic.rate={min(1, 0.5 * bound) / flits:.6f}", "workload.traffic.packets=20000",
                          "topology.link.virtual_channels=8", "topology.link.depth=8"]
                words = [word for one in loaded for word in ("--set", one)]
                traffic = json.loads(self.run_program("run", file, "--json", "--force", *words))["traffic"]
                self.assertEqual(traffic["delivered"], 20000)
                self.assertAlmostEqual(traffic["accepted"] / traffic["offered"], 1, delta=0.01)


if __name__ == "__main__":
    unittest.main()
