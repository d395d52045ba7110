"""Rays that wait at nodes: collections, the policy that chooses among them, and their bounded storage ("Collections")."""
import struct

from .clock import ceil_div

BUCKETS = 256


def octave_eighths(x):
    return struct.unpack("<I", struct.pack("<f", x if x > 0 else 0.0))[0] >> 20


class Collection:
    __slots__ = ("node", "depth", "entry", "rays", "ready", "bucket", "turn", "place")


class Collections:
    def __init__(self, config, facts):
        c = config["collections"]
        self.block = config["packets"]["rays"]
        self.ready, self.policy = c["ready"], c["policy"]
        self.strict = c["select"] == "strict"
        self.capacity = c["capacity"] // self.block
        self.scene_size, self.max_depth = facts["scene_size"], facts["max_depth"]
        self.by_node = {}
        self.turns = 0
        self.free_places, self.places = [], 0

    def __len__(self):
        return len(self.by_node)

    def memberships(self):
        return sum(len(c.rays) for c in self.by_node.values())

    def free_blocks(self):
        return self.capacity - sum(ceil_div(len(c.rays), self.block) for c in self.by_node.values())

    def bucket(self, c):
        if self.policy == "fullest":
            return BUCKETS - 1 - min(BUCKETS - 1, len(c.rays) * 128 // self.ready)
        if self.policy == "deepest":
            return min(BUCKETS - 1, max(0, self.max_depth - c.depth))
        if self.policy == "nearest":
            base = max(0, octave_eighths(self.scene_size if self.scene_size > 0 else 1.0) - 27 * 8)
            return min(BUCKETS - 1, max(0, octave_eighths(c.entry) - base))
        return 0

    def enlist(self, c, ready, bucket):
        self.turns += 1
        c.ready, c.bucket, c.turn = ready, bucket, self.turns

    def relist(self, c):
        ready, bucket = self.strict or len(c.rays) >= self.ready, self.bucket(c)
        if (ready, bucket) != (c.ready, c.bucket):
            self.enlist(c, ready, bucket)

    def add(self, node, depth, entry, rays):
        if not rays:
            return
        c = self.by_node.get(node)
        if c is None:
            c = Collection()
            c.node, c.depth, c.entry, c.rays = node, depth, entry, []
            if self.free_places:
                c.place = self.free_places.pop()
            else:
                c.place, self.places = self.places, self.places + 1
            self.by_node[node] = c
            self.enlist(c, self.strict, self.bucket(c))
        c.entry = min(c.entry, entry)
        c.rays.extend(rays)
        self.relist(c)

    def best(self, partial):
        newest = self.policy == "newest"
        order = lambda c: (c.bucket, -c.turn if newest else c.turn)
        for ready in (True, False) if partial else (True,):
            some = [c for c in self.by_node.values() if c.ready == ready]
            if some:
                return min(some, key=order)
        return None

    def deepest(self):
        return min(self.by_node.values(), key=lambda c: (-c.depth, c.place))

    def take(self, c):
        """The rays of its first block."""
        rays, c.rays = c.rays[:self.block], c.rays[self.block:]
        if c.rays:
            self.relist(c)
        else:
            del self.by_node[c.node]
            self.free_places.append(c.place)
        return rays


class Storage:
    """The rule of `when_full: reserve`; with `spill` everything may."""

    def __init__(self, config, facts, store):
        c = config["collections"]
        self.store = store
        self.bounded = c["when_full"] == "reserve"
        self.ray_a_block = c["traversal"] == "ordered"
        self.block = config["packets"]["rays"]
        self.blocks = c["capacity"] // self.block
        width = facts["width"]
        self.reserve = 0 if self.ray_a_block else (width - 1) * (facts["max_depth"] + 1) + width
        self.promised = self.held = 0

    def admissible(self):
        if not self.bounded:
            return 1 << 31
        if self.ray_a_block:
            return max(0, self.blocks - self.held)
        room = self.store.free_blocks() - self.promised - max(self.reserve, self.blocks // 2)
        return max(0, room * self.block)

    def fits(self, needed, freed):
        return not self.bounded or self.store.free_blocks() + freed - self.promised - needed >= self.reserve

    def retire(self, needed, rays, joined):
        self.promised -= needed
        if self.ray_a_block and self.bounded:
            self.held -= rays - joined
