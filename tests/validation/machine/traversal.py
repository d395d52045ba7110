"""How rays go down the tree: what a packet's visit tests, and which collections its rays join afterwards ("Visits")."""
from .testers import Counts
from .walk import Walk, last_first


class Transforms:
    """Which rays have to be brought to model space at a visit."""

    def __init__(self, config):
        a = config["accuracy"]
        self.store = a["transformed_ray"] == "store"
        data = a.get("instance_data") or ("forward" if a.get("invert") == "visit" else "")
        self.forward = data == "forward"
        self.full = a["transform"] == "inverse_matrix"

    def needs(self, ray, node):
        if not self.store:
            return True
        if node.instance in ray.kept:
            return False
        ray.kept.add(node.instance)
        return True

    def invert(self, node, counts):
        counts.inversions = int(self.forward and not node.transposed)
        counts.full_inversions = counts.inversions if self.full and not node.promoted else 0

    def charge(self, rays, node, counts):
        if not node.moves:
            return
        counts.transforms = sum(self.needs(ray, node) for ray in rays if not ray.done)
        counts.in_double = counts.transforms if node.promoted else 0
        if counts.transforms > 0:
            self.invert(node, counts)


class Spread:
    """Every ray joins the collections of all children that it hits. A packet tests a strip, or with `packets.shapes:
    single` one shape of it, and then a ray waits for as many tests at a node as the strip has shapes."""

    ordered = False

    def __init__(self, config, facts, nodes):
        self.nodes = nodes
        self.transforms = Transforms(config)
        self.single = config["packets"]["shapes"] == "single"
        self.per_child = config["packets"].get("made_per") == "child"
        self.order = config["collections"]["order"]
        treelets = config["collections"]["traversal"] == "treelet"
        self.most_triangles = config["bvh"]["treelet_triangles"] if treelets else None

    def is_treelet(self, node):
        return self.most_triangles is not None and self.nodes[node].triangles_below <= self.most_triangles

    def tests_at(self, node):
        if not self.single or self.is_treelet(node):
            return 1
        return max(1, self.nodes[node].shapes)

    def collections_at(self, node):
        """That a ray joins which comes to a node."""
        return self.tests_at(node) if self.per_child else 1

    def blocks_needed(self, node, rays):
        if self.is_treelet(node) or not self.nodes[node].inner:
            return 0
        if self.per_child:
            return max([1] + [self.tests_at(child) for child in self.nodes[node].children])
        return 1 if self.single else len(self.nodes[node].children)

    def lanes(self, packet):
        node = self.nodes[packet.node]
        return range(node.shapes) if packet.lane is None else [lane for lane in [packet.lane] if lane < node.shapes]

    def test(self, packet, members, complete):
        """Tests the rays at the places `members` of the packet; `complete` takes those that wait for nothing more."""
        if self.is_treelet(packet.node):
            return self.walk(packet, members, complete)
        node, counts = self.nodes[packet.node], Counts()
        rays = [packet.rays[i] for i in members]
        self.transforms.charge(rays, node, counts)
        lanes = self.lanes(packet)
        below = self.tests_at(node.children[packet.lane]) if node.inner and packet.lane in lanes else 1
        for i, ray in zip(members, rays):
            hits = []
            if not ray.done and node.inner:
                counts.box += len(lanes)
                hits = ray.meet_boxes(node, lanes)
            elif not ray.done:
                if node.procedural:
                    counts.procedural += len(lanes)
                else:
                    counts.triangle += len(lanes)
                counts.refined += ray.meet_triangles(node, lanes)
            packet.masks[i] = [lane for lane, _ in hits]
            for lane, entry in hits:
                packet.nearest[lane] = min(packet.nearest[lane], entry)
            ray.pending += len(hits) * below - 1
            if ray.pending == 0:
                complete(ray)
        return counts

    def walk(self, packet, members, complete):
        """The ways of the rays through a treelet: for each its steps (node, tests)."""
        ways = []
        for i in members:
            ray, steps = packet.rays[i], []
            walk = Walk(ray, packet.node, self.nodes, self.transforms, self.order)
            while (node := walk.next()) is not None:
                steps.append((node, walk.test(node)))
            ways.append(steps)
        for i in members:
            packet.rays[i].pending -= 1
            if packet.rays[i].pending == 0:
                complete(packet.rays[i])
        return ways

    def retire(self, packet, collections, now):
        node = self.nodes[packet.node]
        if self.is_treelet(packet.node):
            return
        for lane, child in enumerate(node.children):
            rays = [ray for ray, mask in zip(packet.rays, packet.masks) if lane in mask]
            for shape in range(self.collections_at(child)):
                collections.add(child, packet.depth + 1, packet.nearest[lane], rays, now, shape)


class Ordered(Spread):
    """A ray is in one collection, that of its next node; the others wait on its stack."""

    ordered = True

    def __init__(self, config, facts, nodes):
        super().__init__(config, facts, nodes)
        self.by_block = config["collections"].get("key") == "block"
        self.first = {}  # number of the first node of the tree by its block: the one that is named for all of them
        if self.by_block:
            for number, node in enumerate(nodes):
                self.first.setdefault(node.block[2], number)

    def blocks_needed(self, node, rays):
        return rays

    def test(self, packet, members, complete):
        node, counts = self.nodes[packet.node], Counts()
        rays = [packet.rays[i] for i in members]
        self.transforms.charge(rays, node, counts)
        places = list(zip(members, rays))
        if self.by_block:
            places.sort(key=lambda place: (place[1].at[1], self.nodes[place[1].at[0]].key))
        for i, ray in places:
            depth = packet.depth
            if self.by_block:
                node, depth = self.nodes[ray.at[0]], ray.at[1]
            if not ray.done and node.inner:
                counts.box += node.shapes
                hits = ray.meet_boxes(node, range(node.shapes))
                for lane, entry in hits:
                    packet.nearest[lane] = min(packet.nearest[lane], entry)
                for lane, entry in last_first(self.order, hits):
                    ray.stack.append((node.children[lane], entry, depth + 1))
            elif not ray.done:
                if node.procedural:
                    counts.procedural += node.shapes
                else:
                    counts.triangle += node.shapes
                counts.refined += ray.meet_triangles(node, range(node.shapes))
            packet.next[i] = self.next_of(ray)
            if packet.next[i] is None:
                ray.pending -= 1
                if ray.pending == 0:
                    complete(ray)
            elif self.by_block:
                number, entry, below = packet.next[i]
                ray.at = number, below
                packet.next[i] = self.first[self.nodes[number].block[2]], entry, below
        return counts

    @staticmethod
    def next_of(ray):
        while ray.stack and not ray.done:
            if ray.stack[-1][1] <= ray.t:
                return ray.stack.pop()
            ray.stack.pop()
        ray.stack.clear()
        return None

    def retire(self, packet, collections, now):
        for ray, following in zip(packet.rays, packet.next):
            if following is not None:
                node, entry, depth = following
                collections.add(node, depth, entry, [ray], now)
