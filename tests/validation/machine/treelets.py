"""Rays that gather at treelets of the whole tree ("Treelets of the whole tree")."""
from .clock import ceil_div
from .traversal import Spread
from .walk import Walk


class PieceWalk(Walk):
    """A walk that stays in the treelet in which it begins. `exits`: [(node, entry, depth below its start)]."""

    def __init__(self, ray, root, nodes, transforms, order):
        super().__init__(ray, root, nodes, transforms, order)
        self.depths, self.exits = {root: 0}, []

    def test(self, number):
        below = len(self.stack)
        counts = super().test(number)
        new, self.stack = self.stack[below:], self.stack[:below]
        leaving = []
        for child, entry in new:
            self.depths[child] = self.depths[number] + 1
            inside = (self.nodes[child].instance == self.nodes[number].instance and
                      self.nodes[child].treelet[0] == self.nodes[number].treelet[0])
            if inside:
                self.stack.append((child, entry))
            else:
                leaving.append((child, entry, self.depths[child]))
        self.exits += reversed(leaving)
        return counts


class Treelets(Spread):
    """`all_at_once`: a ray joins the collections of all treelets below that it enters before its hit. Otherwise it joins
    that of the next one, and the others wait on its stack."""

    def __init__(self, config, facts, nodes):
        super().__init__(config, facts, nodes)
        self.ordered = config["collections"]["traversal"] == "ordered"

    def is_treelet(self, node):
        return True

    def tests_at(self, node):
        return 1

    def blocks_needed(self, node, rays):
        return rays if self.ordered else self.nodes[node].treelet[2]

    def test(self, packet, members, complete):
        """The ways of the rays, as Spread.walk(), and the reads of the ray store besides one a ray."""
        ways, exits, extra = [], [], 0
        for i in members:
            node, depth = packet.place_of(i)
            walk, steps = PieceWalk(packet.rays[i], node, self.nodes, self.transforms, self.order), []
            while (node := walk.next()) is not None:
                steps.append((node, walk.test(node)))
            ways.append(steps)
            exits.append([(node, entry, depth + below) for node, entry, below in walk.exits])
        for i, met in zip(members, exits):
            ray = packet.rays[i]
            met = [] if ray.done else [exit for exit in met if exit[1] <= ray.t]
            if not self.ordered:
                packet.exits += [(ray, *exit) for exit in met]
                ray.pending += len(met) - 1
            else:
                moved = self.go_on(ray, met)
                packet.next[i] = ray.at
                extra += ceil_div(12 * moved, 64)
                ray.pending -= ray.at is None
            if ray.pending == 0:
                complete(ray)
        packet.extra_reads = extra
        return ways

    def go_on(self, ray, met):
        """Sets `ray.at` to the next treelet, or nothing. Returns the entries that the stack has taken or given."""
        if ray.done:
            ray.stack.clear()
        met = met[::-1]
        if self.order == "nearest":
            met.sort(key=lambda exit: -exit[1])
        if met:
            ray.stack += met[:-1]
            ray.at = met[-1]
            return len(met) - 1
        moved, ray.at = 0, None
        while ray.at is None and ray.stack:
            moved += 1
            top = ray.stack.pop()
            ray.at = top if top[1] <= ray.t else None
        return moved

    def retire(self, packet, collections, now):
        for ray, node, entry, depth in packet.exits:
            collections.add(node, depth, entry, [ray], now)
        for ray, following in zip(packet.rays, packet.next):
            if following is not None:
                node, entry, depth = following
                collections.add(node, depth, entry, [ray], now)
