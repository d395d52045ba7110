"""Rays that wait at nodes: collections, the policy that chooses among them, and their bounded storage ("Collections")."""
import struct

from .clock import ceil_div

BUCKETS = 256


def octave_eighths(x):
    return struct.unpack("<I", struct.pack("<f", x if x > 0 else 0.0))[0] >> 20


class Collection:
    __slots__ = ("node", "depth", "entry", "rays", "blocks", "ready", "bucket", "turn", "place", "ripe", "since", "shape")


class Collections:
    def __init__(self, config, facts):
        c = config["collections"]
        self.packet = config["packets"]["rays"]
        self.block = 1 if c["traversal"] == "ordered" else self.packet
        self.ready, self.policy = c["ready"], c["policy"]
        self.strict = c["select"] == "strict"
        self.ripe_after = c["partial_after_cycles"] if c["partial"] == "after" else None
        self.capacity = c["capacity"] // self.block
        self.scene_size, self.max_depth = facts["scene_size"], facts["max_depth"]
        self.by_node = {}
        self.turns = self.waits = 0
        self.free_places, self.places = [], 0
        self.used = 0                              # blocks, spilled ones included
        self.spilled, self.free_numbers, self.numbers = 0, [], 0
        self.written, self.read = [], []           # of spilled blocks: (number, first ID, IDs)

    def __len__(self):
        return len(self.by_node)

    def memberships(self):
        return sum(len(c.rays) for c in self.by_node.values())

    def free_blocks(self):
        return self.capacity - self.used

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
        ready, bucket = self.strict or c.ripe or len(c.rays) >= self.ready, self.bucket(c)
        if (ready, bucket) != (c.ready, c.bucket):
            self.enlist(c, ready, bucket)

    def begin_to_wait(self, c, now):
        self.waits += 1
        c.ripe, c.since = False, (now, self.waits)

    def ripen(self, now):
        """Those that have waited for long enough become ready."""
        while (at := self.next_ripe()) is not None and at <= now:
            c = self.waits_longest()
            c.ripe = True
            self.relist(c)

    def waits_longest(self):
        return min((c for c in self.by_node.values() if not c.ready), key=lambda c: c.since, default=None)

    def next_ripe(self):
        if self.ripe_after is None or (c := self.waits_longest()) is None:
            return None
        return c.since[0] + self.ripe_after

    def add(self, node, depth, entry, rays, now, shape=0):
        if not rays:
            return
        c = self.by_node.get((node, shape))
        if c is None:
            c = Collection()
            c.node, c.depth, c.entry, c.rays, c.blocks, c.shape = node, depth, entry, [], [], shape
            if self.free_places:
                c.place = self.free_places.pop()
            else:
                c.place, self.places = self.places, self.places + 1
            self.by_node[node, shape] = c
            self.begin_to_wait(c, now)
            self.enlist(c, self.strict, self.bucket(c))
        c.entry = min(c.entry, entry)
        done = 0
        while done < len(rays):
            filled = len(c.rays) % self.block
            if filled == 0:
                c.blocks.append(self.new_block())
            n = min(self.block - filled, len(rays) - done)
            c.rays.extend(rays[done:done + n])
            done += n
            if c.blocks[-1] is not None:
                self.written.append((c.blocks[-1], filled, n))
        self.relist(c)

    def new_block(self):
        """The number of a spilled block; nothing for one that is not."""
        full = self.used - self.spilled >= self.capacity
        self.used += 1
        if not full:
            return None
        self.spilled += 1
        if self.free_numbers:
            return self.free_numbers.pop()
        self.numbers += 1
        return self.numbers - 1

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

    def front_blocks(self, c):
        return ceil_div(min(len(c.rays), self.packet), self.block)

    def take(self, c, now):
        """The rays of its first packet."""
        rays, c.rays = c.rays[:self.packet], c.rays[self.packet:]
        for first in range(0, len(rays), self.block):
            number = c.blocks.pop(0)
            self.used -= 1
            if number is not None:
                self.read.append((number, 0, min(self.block, len(rays) - first)))
                self.free_numbers.append(number)
                self.spilled -= 1
        if c.rays:
            self.begin_to_wait(c, now)
            self.relist(c)
        else:
            del self.by_node[c.node, c.shape]
            self.free_places.append(c.place)
        return rays


class Storage:
    """The rule of `when_full: reserve`; with `spill` everything may."""

    def __init__(self, config, facts, store, collections_at_root):
        c = config["collections"]
        self.store = store
        self.bounded = c["when_full"] == "reserve"
        self.single = c["traversal"] == "ordered"
        self.block, self.blocks = store.block, store.capacity
        per_child = config["packets"].get("made_per") == "child"
        width = max(facts["width"], 16) if per_child else facts["ways"]
        self.collections_at_root = collections_at_root
        self.reserve = 0 if self.single else (width - 1) * (facts["levels"] + 1) + width
        self.promised = self.held = 0

    def admissible(self):
        if not self.bounded:
            return 1 << 31
        if self.single:
            return max(0, self.blocks - self.held)
        room = self.store.free_blocks() - self.promised - max(self.reserve, self.blocks // 2)
        return max(0, room // self.collections_at_root * self.block)

    def fits(self, needed, freed):
        return not self.bounded or self.store.free_blocks() + freed - self.promised - needed >= self.reserve

    def retire(self, needed, rays, joined):
        self.promised -= needed
        if self.single and self.bounded:
            self.held -= rays - joined
