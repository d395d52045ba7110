"""Shape data: a resource's buffer, the shared caches, the memory behind them ("Memory")."""
from .clock import Channel, ceil_div, way_back, way_there

PLACE = 256


class LineCache:
    def __init__(self, lines, ways):
        self.ways, self.sets = ways, max(1, lines // ways)
        self.sets = 1 << (self.sets.bit_length() - 1)
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


class ShapeBuffer:
    def __init__(self, config):
        self.cache = LineCache(config["memory"]["shape_buffer_kib"] * 1024 // PLACE, 16)

    @staticmethod
    def _places(span):
        address, size = span
        for at in range(0, size, PLACE):
            mixed = (address + at) * 0x9e3779b97f4a7c15 & (1 << 64) - 1
            yield (mixed >> 40 | mixed << 24) & (1 << 64) - 1

    def has(self, span):
        return all([self.cache.touch(place) for place in self._places(span)])

    def keep(self, span):
        for place in self._places(span):
            self.cache.insert(place)


class ShapePort:
    """A resource's access to shape data."""

    def __init__(self, config, clock):
        self.buffer = ShapeBuffer(config)
        self.requests, self.answers = Channel(clock), Channel(clock)
        self.latency = way_there(config["memory"]["l2_latency_cycles"])
        self.line = config["memory"]["line_bytes"]

    def request(self, span, tag, now):
        address, size = span
        first, last = address // self.line, (address + size - 1) // self.line
        self.requests.send(now + self.latency, (first, last - first + 1, tag))


class Request:
    def __init__(self, client, tag, ready):
        self.client, self.tag, self.ready, self.missing = client, tag, ready, 0


class Cache:
    """An L2 that some resources share: a line a cycle."""

    def __init__(self, config, clock, ports):
        m = config["memory"]
        self.lines = LineCache(m["l2_kib"] * 1024 // m["line_bytes"], m["ways"])
        self.ports = ports
        self.back = way_back(m["l2_latency_cycles"])
        self.to_memory, self.from_memory = Channel(clock), Channel(clock)
        self.memory_latency = way_there(m["dram_latency_cycles"])
        self.port_free = 0
        self.waiting = {}  # line: requests, in the order in which they asked
        self.last_answer = [0] * len(ports)

    def step(self, now):
        while self.from_memory.ready(now):
            self.fill(self.from_memory.take(), now)
        for client, port in enumerate(self.ports):
            while port.requests.ready(now):
                self.look_up(client, port.requests.take(), now)

    def look_up(self, client, asked, now):
        first, lines, tag = asked
        request = Request(client, tag, 0)
        self.port_free = max(self.port_free, now)
        for line in range(first, first + lines):
            self.port_free += 1
            request.ready = self.port_free
            if self.lines.touch(line):
                continue
            request.missing += 1
            if line not in self.waiting:
                self.waiting[line] = []
                self.to_memory.send(self.port_free + self.memory_latency, line)
            self.waiting[line].append(request)
        if request.missing == 0:
            self.answer(request)

    def fill(self, line, now):
        self.lines.insert(line)
        for request in self.waiting.pop(line):
            request.ready = max(request.ready, now)
            request.missing -= 1
            if request.missing == 0:
                self.answer(request)

    def answer(self, request):
        last = max(self.last_answer[request.client], request.ready + self.back)
        self.last_answer[request.client] = last
        self.ports[request.client].answers.send(last, request.tag)


class Memory:
    def __init__(self, config, caches):
        m = config["memory"]
        self.caches, self.free_at = caches, 0
        self.back = way_back(m["dram_latency_cycles"])
        self.line_cycles = ceil_div(m["line_bytes"], m["dram_bytes_per_cycle"])

    def step(self, now):
        for cache in self.caches:
            while cache.to_memory.ready(now):
                self.free_at = max(self.free_at, now) + self.line_cycles
                cache.from_memory.send(self.free_at + self.back, cache.to_memory.take())
