"""Time, and channels between the parts of a machine (docs/internals/cycle-engine-exact.md, "Time")."""
import heapq
from collections import deque


class Clock:
    """The cycles in which something may happen. All parts step in each of them; a step with nothing to do is idle."""

    def __init__(self):
        self.heap = []
        self.known = set()

    def wake(self, at):
        if at not in self.known:
            self.known.add(at)
            heapq.heappush(self.heap, at)

    def next(self):
        at = heapq.heappop(self.heap)
        self.known.discard(at)
        return at


class Channel:
    """First in, first out; arrival times never decrease."""

    def __init__(self, clock):
        self.clock = clock
        self.items = deque()
        self.last = 0

    def send(self, at, thing):
        assert at >= self.last, "a channel's arrival times decrease"
        self.last = at
        self.items.append((at, thing))
        self.clock.wake(at)

    def ready(self, now):
        return bool(self.items) and self.items[0][0] <= now

    def front(self):
        return self.items[0][1]

    def take(self, place=0):
        thing = self.items[place][1]
        del self.items[place]
        return thing

    def arrived(self, now):
        """The things that have arrived and have not been taken."""
        return [thing for at, thing in self.items if at <= now]


def ceil_div(n, by):
    return -(-n // by)


def way_there(latency):
    return 1 if latency < 2 else latency // 2


def way_back(latency):
    return 1 if latency < 2 else latency - way_there(latency)


class SideWire:
    """A wire beside the links, as wide as one."""

    def __init__(self, clock, config, latency):
        self.channel, self.latency = Channel(clock), latency
        self.width, self.free_at = config["topology"]["link"]["bytes_per_cycle"], 0

    def send(self, size, now, thing):
        self.free_at = max(self.free_at, now) + ceil_div(size, self.width)
        self.channel.send(self.free_at - 1 + self.latency, thing)


class Trace:
    """The steps of all parts, to be compared with the engine's."""

    def __init__(self):
        self.steps = []

    def note(self, at, node, kind, packet, rays):
        self.steps.append((at, node, kind, packet, rays))
