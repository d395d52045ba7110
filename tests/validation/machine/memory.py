"""Shape data: a resource's buffer, the shared caches, the memory behind them ("Memory")."""
from .clock import Channel, SideWire, ceil_div, way_back, way_there
REQUEST = 16  # bytes


class LineCache:
    def __init__(self, lines, ways):
        self.ways, self.sets = ways, max(1, lines // ways)
        self.lines = [[] for _ in range(self.sets)]  # most recently used first

    def touch(self, line):
        entries = self.lines[line % self.sets]
        if line not in entries:
            return False
        entries.remove(line)
        entries.insert(0, line)
        return True

    def insert(self, line):
        if self.touch(line):
            return
        entries = self.lines[line % self.sets]
        entries.insert(0, line)
        del entries[self.ways:]


class ShapePort:
    """A resource's end of the wires to its cache."""

    def __init__(self, config, clock):
        self.wire = SideWire(clock, config, way_there(config["memory"]["l2_latency_cycles"]))
        self.requests, self.answers = self.wire.channel, Channel(clock)
        self.line = config["memory"]["line_bytes"]

    def request(self, span, tag, now):
        """Reads the lines of `span`; `tag` comes back. Without a tag it writes them."""
        address, size = span
        first, last = address // self.line, (address + size - 1) // self.line
        self.wire.send(REQUEST + (size if tag is None else 0), now, (first, last - first + 1, tag))


class Request:
    def __init__(self, client, tag):
        self.client, self.tag, self.ready, self.missing = client, tag, 0, 0


class Cache:
    """An L2 that some resources share. Its port looks up so many lines a cycle."""

    def __init__(self, config, clock, ports):
        m = config["memory"]
        self.clock, self.ports = clock, ports
        self.lines = LineCache(m["l2_kib"] * 1024 // m["line_bytes"], m["ways"])
        self.back = way_back(m["l2_latency_cycles"])
        self.to_memory, self.from_memory = Channel(clock), Channel(clock)
        self.memory_latency = way_there(m["dram_latency_cycles"])
        self.lines_a_cycle = m["l2_lines_per_cycle"]
        self.looked_up = 0  # in lines: a cycle has lines_a_cycle of them
        self.waiting = {}   # line: requests, in the order in which they asked
        self.complete = []  # requests that wait for their answer to leave

    def step(self, now):
        while self.from_memory.ready(now):
            self.fill(self.from_memory.take(), now)
        for client, port in enumerate(self.ports):
            while port.requests.ready(now):
                self.look_up(Request(client, port.requests.front()[2]), port.requests.take(), now)
        for request in [request for request in self.complete if request.ready <= now]:
            self.complete.remove(request)
            self.ports[request.client].answers.send(now + self.back, request.tag)

    def look_up(self, request, asked, now):
        first, lines, tag = asked
        for line in range(first, first + lines):
            self.looked_up = max(self.looked_up, now * self.lines_a_cycle) + 1
            request.ready = ceil_div(self.looked_up, self.lines_a_cycle)
            there = self.lines.touch(line)
            if tag is None:  # a write, which goes through
                self.to_memory.send(request.ready + self.memory_latency, (line, True))
            if there or tag is None:
                continue
            request.missing += 1
            if line not in self.waiting:
                self.waiting[line] = []
                self.to_memory.send(request.ready + self.memory_latency, (line, False))
            self.waiting[line].append(request)
        if tag is not None:
            self.complete_if_all_there(request)

    def fill(self, line, now):
        self.lines.insert(line)
        for request in self.waiting.pop(line):
            request.ready = max(request.ready, now)
            request.missing -= 1
            self.complete_if_all_there(request)

    def complete_if_all_there(self, request):
        if request.missing == 0:
            self.complete.append(request)
            self.clock.wake(request.ready)


class Memory:
    """One channel of so many bytes a cycle."""

    def __init__(self, config, caches):
        m = config["memory"]
        self.caches = caches
        self.back = way_back(m["dram_latency_cycles"])
        self.line, self.width = m["line_bytes"], m["dram_bytes_per_cycle"]
        self.moved = 0  # in bytes: a cycle has `width` of them

    def step(self, now):
        for cache in self.caches:
            while cache.to_memory.ready(now):
                self.moved = max(self.moved, now * self.width) + self.line
                line, write = cache.to_memory.take()
                if not write:  # a line that is written gets no answer
                    cache.from_memory.send(ceil_div(self.moved, self.width) + self.back, line)
