"""Links, and who is linked to whom ("Links")."""
from collections import deque

from .clock import Channel, way_back, way_there


class Packet:
    def __init__(self, number, owner, direction):
        self.number, self.owner, self.direction = number, owner, direction
        self.home = owner
        self.memberships = False  # carries memberships to their home; otherwise rays to be tested
        self.node = None
        self.depth = 0
        self.lane = None          # the one shape it tests; None: the whole strip
        self.rays, self.masks = [], []
        self.nearest = []
        self.next = []            # ordered traversal: one a ray
        self.exits = []           # where rays leave treelets of the whole tree: (ray, node, entry, depth)
        self.groups = []          # of members from a place on that are at another treelet: (place, node, depth)
        self.extra_reads = 0      # of the ray store, by its last tests, besides one a ray
        self.owners = set()
        self.blocks = 0           # of collection storage that its retirement may take
        self.answered = 0         # rays that have been tested; on a bus, by its owner
        self.due = 0              # on a bus: answers that have not come
        self.records = None       # of new rays that look for slots: (ray, address)
        self.left = 0             # then: resources after the next one

    def place_of(self, member):
        """The node at which a member is, and that one's depth."""
        places = [(node, depth) for first, node, depth in self.groups if first <= member]
        return places[-1] if places else (self.node, self.depth)


class Token:
    """A packet on a link, with the number of resources to pass before one that has work with it."""

    def __init__(self, packet, skip, cycles, entries=0, answers=False, passes=False):
        self.packet, self.skip, self.cycles = packet, skip, cycles
        self.entries = entries  # that dispatch reads where it is an answer, or not meant for the resource
        self.answers = answers  # on a bus, an answer on its way to the packet's owner
        self.passes = passes    # on a bus, heard by a resource that has none of its rays
        self.stop, self.sizes = None, None  # in a graph: the resource where it goes, and its cycles by width


class InPort:
    def __init__(self, packets, credits, latency):
        self.packets, self.credits, self.latency = packets, credits, latency

    def ready(self, now):
        return self.packets.ready(now)

    def front(self):
        return self.packets.front()

    def take(self, now, place=0):
        self.credits.send(now + self.latency, None)
        return self.packets.take(place)

    def window(self, now, length):
        return self.packets.arrived(now)[:length]

    def bring_forward(self, place):
        item = self.packets.items[place]
        del self.packets.items[place]
        self.packets.items.appendleft(item)


class OutPort:
    def __init__(self, clock, packets, credits, latency, depth, places):
        self.clock, self.packets, self.credit_channel, self.latency = clock, packets, credits, latency
        self.credits, self.places = depth, places
        self.queue, self.reserved, self.free_at = deque(), 0, 0

    def has_place(self):
        return len(self.queue) + self.reserved < self.places

    def spare_places(self):
        return self.credits - len(self.queue) - self.reserved

    def push(self, token, ready, cut_through):
        self.queue.append((token, ready, cut_through))
        self.clock.wake(ready)

    def take_credits(self, now):
        while self.credit_channel.ready(now):
            self.credit_channel.take()
            self.credits += 1

    def send(self, now):
        if not self.queue or self.free_at > now or self.queue[0][1] > now or self.credits == 0:
            return False
        token, _, cut_through = self.queue.popleft()
        self.credits -= 1
        self.free_at = now + token.cycles
        self.clock.wake(self.free_at)
        self.packets.send(now + self.latency + (0 if cut_through else token.cycles - 1), token)
        return True


class Topology:
    """The rounds of a ring, of two opposite rings, or of several rings side by side."""

    def __init__(self, config):
        t = config["topology"]
        self.resources, self.shape = t["resources"], t["shape"]
        self.visit_all = t["visit"] == "all"
        forward, backward = 1, self.resources - 1
        self.bus = self.shape == "bus"
        self.steps = {"ring": [forward], "bidirectional": [forward, backward], "independent": [forward], "central": [forward],
                      "bus": [forward], "multi_ring": [forward] * t["rings"]}[self.shape]
        self.directions = len(self.steps)
        depth = t["link"]["depth"]
        self.in_flight = depth if t["flow"] == "credits" else min(depth * self.resources, 256)

    def next(self, here, direction):
        return (here + self.steps[direction]) % self.resources

    def wanted(self, packet, at):
        return at == packet.home if packet.memberships else at in packet.owners

    def port(self, packet, here):
        return packet.direction

    def travels(self, packet):
        if self.resources == 1:
            return False
        if self.visit_all and not self.bus:
            return True
        if packet.memberships:
            return packet.home != packet.owner
        return any(owner != packet.owner for owner in packet.owners)

    def skip(self, packet, here):
        if self.bus:
            return 0
        at, skip = self.next(here, packet.direction), 0
        while at != packet.owner and not self.wanted(packet, at):
            at, skip = self.next(at, packet.direction), skip + 1
        return skip


def connect(clock, topology, link, places):
    """The ports of each resource, by direction: [(in ports, out ports)]."""
    ends = [([None] * topology.directions, [None] * topology.directions) for _ in range(topology.resources)]
    if topology.bus and topology.resources > 1:
        return connect_bus(clock, topology, link, ends)
    if topology.resources == 1 or topology.shape == "independent":
        return [([], []) for _ in range(topology.resources)]
    for r in range(topology.resources):
        for d in range(topology.directions):
            packets, credits = Channel(clock), Channel(clock)
            ends[r][1][d] = OutPort(clock, packets, credits, link["latency_cycles"], link["depth"], places)
            ends[topology.next(r, d)][0][d] = InPort(packets, credits, link["latency_cycles"])
    return ends


def connect_bus(clock, topology, link, ends):
    """Likewise; and the bus, behind them."""
    there, back = way_there(link["latency_cycles"]), way_back(link["latency_cycles"])
    hub_in, hub_out = [], []
    for r in range(topology.resources):
        up, up_credits, down, down_credits = (Channel(clock) for _ in range(4))
        ends[r][1][0] = OutPort(clock, up, up_credits, there, link["depth"], float("inf"))
        hub_in.append(InPort(up, up_credits, there))
        hub_out.append(OutPort(clock, down, down_credits, back, link["depth"], float("inf")))
        ends[r][0][0] = InPort(down, down_credits, back)
    return [*ends, Bus(clock, topology, hub_in, hub_out)]


class Bus:
    """One medium that all resources hear ("A bus")."""

    def __init__(self, clock, topology, in_ports, out_ports):
        self.clock, self.topology, self.in_ports, self.out_ports = clock, topology, in_ports, out_ports
        self.turn = self.free_at = 0

    def step(self, now):
        for out in self.out_ports:
            out.take_credits(now)
        if self.free_at > now:
            return
        count = len(self.in_ports)
        for i in range(count):
            here = (self.turn + i) % count
            if not self.in_ports[here].ready(now):
                continue
            token = self.in_ports[here].front()
            listeners = self.listeners(token, here)
            if any(self.out_ports[r].spare_places() <= 0 for r in listeners):
                continue
            self.in_ports[here].take(now)
            packet = token.packet
            for r in listeners:
                passes = not token.answers and not packet.memberships and packet.records is None and r not in packet.owners
                self.out_ports[r].push(Token(packet, 0, token.cycles, token.entries, token.answers, passes), now, False)
                assert self.out_ports[r].send(now)
            self.free_at, self.turn = now + token.cycles, here + 1
            self.clock.wake(self.free_at)
            return

    def listeners(self, token, here):
        packet, t = token.packet, self.topology
        if token.answers:
            return [packet.owner]
        if packet.records is not None:
            return [self.topology.next(here, packet.direction)]
        if packet.memberships:
            return [packet.home if here == packet.owner else packet.owner]
        return [r for r in range(t.resources) if r != here and (t.visit_all or r in packet.owners)]
