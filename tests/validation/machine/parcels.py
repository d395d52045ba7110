"""Shapes and rays on drawn links ("Messages on drawn links")."""
from .clock import Channel, ceil_div
from .graph import Drawing
from .memory import Cache, piece_of

DOOR = 1  # cycles from a node's links to its part
ADDRESS = 8  # bytes
SHAPES, RAYS = 0, 1  # doors of a resource


class Parcel:
    def __init__(self, kind, stop, door, size, body):
        self.kind, self.stop, self.door, self.size, self.body = kind, stop, door, size, body


class Link:
    """Parcels go one behind the other without a gap."""

    def __init__(self, clock, latency, width):
        self.channel, self.latency, self.width, self.taken = Channel(clock), latency, width, 0

    def send(self, parcel, ready, by_head):
        begin = max(self.taken, ready * self.width)
        self.taken = begin + max(1, parcel.size)
        leaves = begin // self.width if by_head else ceil_div(self.taken, self.width) - 1
        self.channel.send(leaves + self.latency, parcel)


class Turns:
    """Nodes that hold pieces in turn, so many each, and number their own from zero."""

    def __init__(self, nodes=1, pieces=1):
        self.nodes, self.pieces = nodes, pieces

    def node(self, piece):
        return piece // self.pieces % self.nodes

    def local(self, piece):
        return piece // self.pieces // self.nodes * self.pieces + piece % self.pieces

    def everywhere(self, node, piece):
        return (piece // self.pieces * self.nodes + node) * self.pieces + piece % self.pieces


class End:
    """The near ends of a part's channels to those who ask it."""

    def __init__(self, clock):
        self.clock = clock
        self.requests, self.answers = Channel(clock), Channel(clock)
        self.to_memory, self.from_memory = self.requests, self.answers


class Part:
    """A part of a request: that for the pieces of one bank."""

    def __init__(self, whole, pieces):
        self.whole, self.pieces = whole, pieces


class FetchDoor:
    """A resource that asks caches. `places`: the caches' doors."""

    def __init__(self, port, turns, places):
        self.port, self.turns, self.places = port, turns, places

    def collect(self, now):
        while self.port.requests.ready(now):
            first, pieces, tag, span, _ = self.port.requests.take()
            banks = {}  # in the order of their first pieces
            for piece in range(first, first + pieces):
                banks.setdefault(self.turns.node(piece), []).append(self.turns.local(piece))
            whole = {"tag": tag, "left": len(banks)}
            for bank, own in banks.items():
                asked = (own[0], len(own), Part(whole, len(own)), span, ())
                yield Parcel("shapes", *self.places[bank], 14 if len(span) > 2 else 16, asked)

    def deliver(self, part, now):
        part.whole["left"] -= 1
        if part.whole["left"] == 0:
            self.port.answers.send(now + DOOR, part.whole["tag"])


class CacheDoor:
    """A cache that a resource asks."""

    def __init__(self, end, place, piece):
        self.end, self.place, self.piece = end, place, piece

    def collect(self, now):
        while self.end.answers.ready(now):
            part = self.end.answers.take()
            yield Parcel("shapes", *self.place, part.pieces * self.piece, part)

    def deliver(self, asked, now):
        self.end.requests.send(now + DOOR, asked)


class AskDoor:
    """A cache that asks for pieces; `own`: as it numbers them itself."""

    def __init__(self, cache, own, bank, turns, places, piece):
        self.cache, self.own, self.bank, self.turns, self.places, self.piece = cache, own, bank, turns, places, piece

    def collect(self, now):
        while self.cache.to_memory.ready(now):
            local, write = self.cache.to_memory.take()
            piece = self.own.everywhere(self.bank, local)
            yield Parcel("shapes", *self.places[self.turns.node(piece)], ADDRESS + (self.piece if write else 0),
                         (self.turns.local(piece), write))

    def deliver(self, piece, now):
        self.cache.from_memory.send(now + DOOR, self.own.local(piece))


class AnswerDoor:
    """A cache or a memory that is asked for pieces."""

    def __init__(self, end, turns, bank, place, piece):
        self.end, self.turns, self.bank, self.place, self.piece = end, turns, bank, place, piece

    def collect(self, now):
        while self.end.answers.ready(now):
            yield Parcel("shapes", *self.place, self.piece, self.turns.everywhere(self.bank, self.end.answers.take()))

    def deliver(self, asked, now):
        self.end.requests.send(now + DOOR, asked)


class RayDoor:
    """What a part sends to `place` (or nothing), and what comes to it (or nothing)."""

    def __init__(self, kind, sent, place, size, come):
        self.kind, self.sent, self.place, self.size, self.come = kind, sent, place, size, come

    def collect(self, now):
        while self.sent and self.sent.ready(now):
            rays = self.sent.take()
            yield Parcel(self.kind, *self.place, self.size * len(rays), rays)

    def deliver(self, rays, now):
        self.come.send(now + DOOR, rays)


class Relay:
    """A node: it takes what has come, link by link, and then what its doors send."""

    def __init__(self, number, network):
        self.number, self.network, self.doors = number, network, {}

    def step(self, now):
        for link in self.network.ins[self.number]:
            while link.channel.ready(now):
                parcel = link.channel.take()
                if parcel.stop == self.number:
                    self.doors[parcel.door].deliver(parcel.body, now)
                else:
                    self.network.send(self.number, parcel, now)
        for parcel in [parcel for door in sorted(self.doors) for parcel in self.doors[door].collect(now)]:
            self.network.send(self.number, parcel, now)


class FarControl:
    """Ray control's end of a resource's wires."""

    def __init__(self, control):
        self.ids, self.completed = control.ids, control.completed
        self.questions, self.answers = control.questions, control.answers   # any-hit calls keep their wires


class Parcels:
    """The network of all that is drawn. `ports` and `controls`: of the resources."""

    def __init__(self, config, clock, ports, controls):
        self.config, self.clock, self.ports, self.controls = config, clock, ports, controls
        self.drawing = Drawing(config["topology"])
        self.links = [Link(clock, link[2], link[3]) for link in self.drawing.links]
        self.ways = {kind: self.drawing.ways(None, kind) for kind in ("shapes", "new_rays", "completed_rays")}
        self.ins = [[link for link, ends in zip(self.links, self.drawing.links) if ends[1] == node]
                    for node in range(len(self.drawing.nodes))]
        self.relays = [Relay(node, self) for node in range(len(self.drawing.nodes))]
        self.piece = piece_of(config)

    def send(self, node, parcel, now):
        link = self.ways[parcel.kind][node][parcel.stop]
        _, to, _, width, *_ = self.drawing.links[link]
        by_head = to != parcel.stop and self.drawing.links[self.ways[parcel.kind][to][parcel.stop]][3] == width
        self.links[link].send(parcel, now + self.drawing.nodes[node].get("latency_cycles", 0), by_head)

    def groups_of(self, kind):
        """By entry of the drawing: (its node, the numbers of the group)."""
        return [(node, [self.drawing.numbers[name] for name in self.drawing.groups[node["name"]]])
                for node in self.config["topology"]["nodes"] if node.get("kind") == kind]

    def turns(self, node, count):
        own = node.get("interleave_bytes", "auto")
        return Turns(count, (self.config["memory"]["line_bytes"] if own == "auto" else own) // self.piece)

    def join_caches(self, own):
        """The L2s. `own`: the resources' caches, if they have any."""
        l2 = []
        for node, numbers in self.groups_of("cache"):
            served = node.get("serves")
            clients = sorted(self.drawing.find(served)) if served else range(self.drawing.resources)
            turns = self.turns(node, len(numbers))
            ends = [[End(self.clock) for _ in clients] for _ in numbers]
            for door, r in enumerate(clients):
                places = [(number, door) for number in numbers]
                self.relays[r].doors[SHAPES] = (AskDoor(own[r], Turns(), 0, turns, places, self.piece) if own else
                                                FetchDoor(self.ports[r], turns, places))
                for bank, number in enumerate(numbers):
                    end = ends[bank][door]
                    self.relays[number].doors[door] = (AnswerDoor(end, turns, bank, (r, SHAPES), self.piece) if own else
                                                       CacheDoor(end, (r, SHAPES), self.piece))
            for bank, number in enumerate(numbers):
                cache = Cache(self.config, self.clock, [] if own else ends[bank], ends[bank] if own else ())
                cache.place, cache.turns, cache.bank_number = (number, len(clients)), turns, bank
                l2.append(cache)
        return l2

    def join_memories(self, l2):
        """For each memory that is drawn, who asks it."""
        groups = self.groups_of("memory")
        numbers = [number for _, group in groups for number in group]
        turns = self.turns(groups[0][0], len(numbers)) if groups else None
        askers = [[End(self.clock) for _ in l2] for _ in numbers]
        for i, cache in enumerate(l2 if numbers else []):
            node, door = cache.place
            self.relays[node].doors[door] = AskDoor(cache, cache.turns, cache.bank_number, turns,
                                                    [(number, i) for number in numbers], self.piece)
            for m, number in enumerate(numbers):
                self.relays[number].doors[i] = AnswerDoor(askers[m][i], turns, m, cache.place, self.piece)
        return askers

    def join_rays(self):
        """Ray control's ends of the wires to all resources."""
        pools = self.groups_of("shading")
        if not pools:
            return self.controls
        shading = pools[0][1][0]
        carried = {kind for link in self.config["topology"]["links"] for kind in link.get("carries", [])}
        new, done = "new_rays" in carried, "completed_rays" in carried
        far = [FarControl(control) for control in self.controls]
        for r, (near, control) in enumerate(zip(self.controls, far)):
            come = Channel(self.clock)
            if done:
                control.completed = Channel(self.clock)
            self.relays[r].doors[RAYS] = RayDoor("completed_rays", near.completed if done else None, (shading, r), 64,
                                                 come)
            self.relays[shading].doors[r] = RayDoor("new_rays", near.ids.channel if new else None, (r, RAYS), 68,
                                                    control.completed)
            if new:
                near.new_rays = come
        return far
