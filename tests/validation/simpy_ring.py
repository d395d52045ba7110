#!/usr/bin/env python3
"""The ring of docs/internals/validation.md again, written from its description for SimPy 3 (Debian:
python3-simpy3), to be compared with `workload: {traffic: ...}`. Nothing is shared
with the C++ program: other language, other event engine, other random numbers.

One-way ring, 1-flit packets to uniformly drawn resources (the source among them), queues of `depth` places, bubble
rule, hops of 4 cycles, 3 to get in and 3 to get out. Processes wait for each other within a cycle in three phases:
arrivals and credits, then packets that pass, then packets that want in.

    simpy_ring.py RESOURCES DEPTH RATE PACKETS SEED     prints the mean latency, its 99 % half width, mean routers
"""
import math
import random
import sys

import simpy

HOP, GET_IN, GET_OUT = 4, 3, 3
PASSING, ENTERING = 0.25, 0.5  # when in a cycle


class Node:
    def __init__(self, ring, number):
        self.ring, self.env, self.number = ring, ring.env, number
        self.arrived = []  # packets in the queue at this node: (created, hops left)
        self.source = []  # created here, waiting to get in
        self.credits = ring.depth  # free places in the next node's queue
        self.link_free = 0
        self.inlet_free = 0
        self.sink_free = 0
        self.change = self.env.event()

    def wake(self):
        if not self.change.triggered:
            self.change.succeed()

    def next(self):
        return self.ring.nodes[(self.number + 1) % len(self.ring.nodes)]

    def previous(self):
        return self.ring.nodes[self.number - 1]

    def after(self, cycles, do):
        """Calls do() at the start of the cycle that many cycles from now."""
        yield self.env.timeout(math.floor(self.env.now) + cycles - self.env.now)
        do()

    def send(self, packet):
        self.credits -= 1
        self.link_free = math.floor(self.env.now) + 1
        other = self.next()

        def arrive():
            other.arrived.append(packet)
            other.wake()

        self.env.process(self.after(HOP, arrive))

    def take(self):
        """The first packet of the queue; its place is free for the neighbour after a hop."""
        other = self.previous()

        def credit():
            other.credits += 1
            other.wake()

        self.env.process(self.after(HOP, credit))
        return self.arrived.pop(0)

    def generate(self, packets):
        at = 0
        for index in range(packets):
            at += int(math.log(1.0 - self.ring.random.random()) / math.log(1.0 - self.ring.rate)) + 1
            hops = self.ring.random.randrange(len(self.ring.nodes))
            yield self.env.timeout(at + GET_IN - self.env.now)
            measured = index >= packets // 10
            self.source.append((at, hops, measured))
            if measured:
                self.ring.routers += hops + 1
            self.wake()

    def run(self):
        while True:
            now = math.floor(self.env.now)
            # Phase 1 has been: arrivals and credits of this cycle are in. Phase 2, passing:
            yield self.env.timeout(now + PASSING - self.env.now)
            while self.arrived and self.arrived[0][1] == 0 and self.sink_free <= now:
                self.deliver(self.take(), now)
            if self.arrived and self.arrived[0][1] > 0 and self.credits > 0 and self.link_free <= now:
                created, hops, measured = self.take()
                self.send((created, hops - 1, measured))
            # Phase 3, entering:
            yield self.env.timeout(now + ENTERING - self.env.now)
            if self.source and self.inlet_free <= now:
                created, hops, measured = self.source[0]
                if hops == 0:
                    if self.sink_free <= now:
                        self.deliver(self.source.pop(0), now)
                        self.inlet_free = now + 1
                elif self.credits >= 2 and self.link_free <= now:
                    self.send((created, hops - 1, measured))
                    self.source.pop(0)
                    self.inlet_free = now + 1
            busy = self.source or self.arrived
            self.change = self.env.event()
            tick = self.env.timeout(now + 1 - self.env.now)
            yield tick if busy else self.change
            if busy:
                yield self.env.timeout(0)  # behind the arrivals of the new cycle

    def deliver(self, packet, now):
        self.sink_free = now + 1
        if packet[2]:
            self.ring.latencies.append(now + GET_OUT - packet[0])
        self.ring.left -= 1
        if self.ring.left == 0:
            self.ring.done.succeed()


class Ring:
    def __init__(self, resources, depth, rate, packets, seed):
        self.env = simpy.Environment()
        self.random = random.Random(seed)
        self.depth, self.rate = depth, rate
        self.latencies, self.routers = [], 0
        self.nodes = [Node(self, number) for number in range(resources)]
        each = packets // resources
        self.left = each * resources
        self.done = self.env.event()
        for node in self.nodes:
            self.env.process(node.generate(each))
            self.env.process(node.run())

    def run(self):
        self.env.run(until=self.done)


def main():
    resources, depth, rate, packets, seed = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4]), int(sys.argv[5])
    ring = Ring(resources, depth, rate, packets, seed)
    ring.run()
    count = len(ring.latencies)
    mean = sum(ring.latencies) / count
    batches = 20
    size = count // batches
    means = [sum(ring.latencies[b * size:(b + 1) * size]) / size for b in range(batches)]
    spread = math.sqrt(sum((m - mean) ** 2 for m in means) / (batches - 1) / batches)
    print(f"{mean:.4f} {2.861 * spread:.4f} {ring.routers / count:.4f}")


if __name__ == "__main__":
    main()
