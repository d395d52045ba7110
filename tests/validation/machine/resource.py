"""A resource without a clock: its collections, and the packets that it fills from them ("Packets")."""
from .collections import Collections, Storage
from .traversal import Ordered, Spread
from .treelets import Treelets

NOTHING, PACKET, STORAGE = "nothing", "packet", "storage"


class Resource:
    def __init__(self, number, config, facts, nodes):
        self.number, self.nodes = number, nodes
        self.resources = config["topology"]["resources"]
        self.hash = config["collections"]["home"] == "hash"
        self.by_block = config["collections"].get("key") == "block"
        self.local = self.resources == 1 or config["collections"]["home"] == "local"
        self.collections = Collections(config, facts)
        ordered = config["collections"]["traversal"] == "ordered"
        self.treelets = config["bvh"].get("treelets", {}).get("bytes", 0) > 0
        self.grouped = config["collections"].get("grouped", False)
        method = Treelets if self.treelets else Ordered if ordered else Spread
        self.traversal = method(config, facts, nodes)
        self.storage = Storage(config, facts, self.collections, self.traversal.collections_at(0))
        self.block = config["packets"]["rays"]
        self.in_flight = 0
        self.groups, self.needed = [], 0  # of the block that goes out
        self.rest = None  # of a block that goes out in several packets: (rays, node, depth, entry, next, packets)
        self.completed = []

    def idle(self):
        return len(self.collections) == 0 and self.rest is None

    def home_of(self, node):
        if not self.hash:
            return self.number
        key = self.nodes[node].block[2] if self.by_block else self.nodes[node].key
        return ((key * 0x9e3779b97f4a7c15 & (1 << 64) - 1) >> 33) % self.resources

    def admit(self, rays, now):
        for first in range(0, len(rays), self.block):
            for shape in range(self.traversal.collections_at(0)):
                self.collections.add(0, 0, 0.0, rays[first:first + self.block], now, shape)
        self.storage.held += len(rays)

    def offer(self, partial, packet, now):
        """Fills `packet` from the next collection: among the ready ones, or with `partial` among all."""
        t = self.traversal
        if self.rest is None:
            c = self.collections.best(partial)
            if c is None:
                return NOTHING
            if not self.storage.fits(t.blocks_needed(c.node, min(len(c.rays), self.block)),
                                     self.collections.front_blocks(c)):
                if self.in_flight > 0:
                    return STORAGE
                c = self.collections.deepest()
            node, depth, entry, shape, ready = c.node, c.depth, c.entry, c.shape, c.ready
            rays = self.collections.take(c, now)
            self.groups, self.needed = [], t.blocks_needed(node, len(rays))
            if self.grouped and not ready:
                self.group_up(rays, node, now)
            packets = t.tests_at(node) // t.collections_at(node) if self.home_of(node) == self.number else 1
            self.rest = (rays, node, depth, entry, shape, shape + packets)
        elif self.in_flight > 0 and not self.storage.fits(t.blocks_needed(self.rest[1], 0), 0):
            return STORAGE
        rays, node, depth, entry, number, packets = self.rest
        self.fill(packet, rays, node, depth, entry, number)
        self.rest = (rays, node, depth, entry, number + 1, packets) if number + 1 < packets else None
        return PACKET

    def group_up(self, rays, node, now):
        """Adds the next collections that are not ready, as long as they fit as a whole."""
        if self.home_of(node) != self.number:
            return
        while len(rays) < self.block:
            c = self.collections.best(True)
            if c is None or c.ready:
                return
            n = min(len(c.rays), self.block)
            if len(rays) + n > self.block or self.home_of(c.node) != self.number:
                return
            needed = self.needed + self.traversal.blocks_needed(c.node, n)
            if not self.storage.fits(needed, self.collections.front_blocks(c)):
                return
            self.groups.append((len(rays), c.node, c.depth))
            rays += self.collections.take(c, now)
            self.needed = needed

    def fill(self, packet, rays, node, depth, entry, number):
        packet.home = self.home_of(node)
        packet.memberships = packet.home != packet.owner
        packet.node, packet.depth = node, depth
        packet.lane = number if self.traversal.single and not self.traversal.is_treelet(node) else None
        packet.blocks = 0 if packet.memberships else self.needed
        packet.groups, packet.exits = list(self.groups), []
        packet.rays, packet.masks, packet.next = list(rays), [[] for _ in rays], [None for _ in rays]
        packet.nearest = [float("inf")] * 8
        packet.entry, packet.answered = entry, 0
        packet.owners = {packet.owner} if self.local else {ray.owner for ray in rays}
        self.storage.promised += packet.blocks
        self.in_flight += 1

    def local_members(self, packet):
        return [i for i, ray in enumerate(packet.rays) if ray.owner == self.number]

    def test(self, packet, members):
        return self.traversal.test(packet, members, self.completed.append)

    def retire(self, packet, now):
        before = self.collections.memberships()
        if not packet.memberships:
            self.traversal.retire(packet, self.collections, now)
        self.storage.retire(packet.blocks, len(packet.rays), self.collections.memberships() - before)
        self.in_flight -= 1

    def join(self, packet, now):
        self.collections.add(packet.node, packet.depth, packet.entry, packet.rays, now,
                             packet.lane or 0)
        packet.rays, packet.masks, packet.next = [], [], []
