"""A prefetcher beside an L2 ("Memory", Prefetcher)."""
from .clock import SideWire, way_there


class Prefetcher:
    def __init__(self, config, clock, ports, cache):
        """`ports`: of the resources behind the L2."""
        p = config["prefetcher"]
        self.ahead, self.most, self.reach = p["lines"], p.get("streams", 4), p.get("reach", 64)
        self.hints = []
        for port in ports:
            wire = SideWire(clock, config, way_there(config["memory"]["l2_latency_cycles"]))
            port.hints.append(wire)
            self.hints.append(wire.channel)
        self.wire = SideWire(clock, config, config["topology"]["link"]["latency_cycles"])
        self.requests = self.wire.channel
        cache.prefetcher = self
        self.streams, self.begun = [], 0  # [last, stride, asked] each

    def step(self, now):
        for hints in self.hints:
            while hints.ready(now):
                self.take(hints.take(), now)

    def take(self, line, now):
        for stream in self.streams:
            if abs(line - stream[0]) <= self.reach:
                return self.follow(stream, line, now)
        if len(self.streams) < self.most:
            self.streams.append([line, 0, 0])
        else:
            self.streams[self.begun % self.most] = [line, 0, 0]
        self.begun += 1

    def follow(self, stream, line, now):
        last, stride, asked = stream
        if line == last:
            return
        follows = line - last == stride
        stream[:] = line, line - last, max(0, asked - 1) if follows else 0
        while follows and stream[2] < self.ahead:
            stream[2] += 1
            if line + stream[2] * stride >= 0:
                self.wire.send(16, now, line + stream[2] * stride)


def prefetchers_of(config, clock, ports, l2):
    if not config.get("prefetcher", {}).get("lines"):
        return []
    shared = config["memory"]["shared_by"]
    return [Prefetcher(config, clock, ports[c * shared:(c + 1) * shared], cache) for c, cache in enumerate(l2)]
