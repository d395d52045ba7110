"""Rays that go through a subtree by themselves, depth first ("Walks")."""
import heapq

from .shape_buffer import User
from .testers import Counts


def last_first(order, hits):
    """[(lane, entry)] as they go on a stack: by falling entry, of equal entries the higher lane first; or by falling lane."""
    return sorted(hits, key=lambda hit: (-hit[1] if order == "nearest" else 0, -hit[0]))


class Walk:
    """The way of one ray: its next strip, and its tests there. Hits count at once."""

    def __init__(self, ray, root, nodes, transforms, order):
        self.order, self.ray, self.nodes, self.transforms = order, ray, nodes, transforms
        self.stack, self.in_hand = [(root, 0.0)], True
        self.instance = 0xffffffff

    def next(self, beyond=0):
        """The next strip, if it is not among the oldest `beyond` entries of the stack."""
        if self.ray.done:
            self.stack = []
        while len(self.stack) > beyond:
            node, entry = self.stack.pop()
            self.in_hand = False
            if entry <= self.ray.t:
                return node
        return None

    def waiting(self):
        """The nodes on the stack, the oldest first, without the first child, which is not put there."""
        return [node for node, _ in self.stack[:len(self.stack) - self.in_hand]]

    def bytes(self, nodes):
        return sum(4 if self.nodes[node].inner else 12 for node in nodes)

    def enters(self, node):
        return self.nodes[node].instance != self.instance

    def test(self, number):
        node, counts = self.nodes[number], Counts()
        if self.enters(number):
            self.instance = node.instance
            if node.moves and self.transforms.needs(self.ray, node):
                counts.transforms = 1
                counts.in_double = int(node.promoted)
                self.transforms.invert(node, counts)
        if node.inner:
            counts.box = node.shapes
            for lane, entry in last_first(self.order, self.ray.meet_boxes(node, range(node.shapes))):
                self.stack.append((node.children[lane], entry))
                self.in_hand = True
        else:
            setattr(counts, "procedural" if node.procedural else "triangle", node.shapes)
            counts.refined = self.ray.meet_triangles(node, range(node.shapes))
        return counts


class Visitor:
    """A ray of a treelet's visit: the steps of its way, taken one after another under the clock."""

    def __init__(self, visit, steps):
        self.visit, self.steps, self.at, self.user = visit, steps, 0, User(self)
        self.in_test = False


class Visit:
    def __init__(self, ways, extra_reads=0, loaded=False):
        self.extra_reads = extra_reads  # of the ray store, before its first ray begins
        self.loaded = loaded            # its context holds the treelet and its transform to the end
        self.rays = [Visitor(self, steps) for steps in ways]
        self.left = len(self.rays)
        self.inverted = {}  # by instance: the end of the inversion


class Visits:
    """The treelet visits of a resource."""

    def __init__(self, clock, nodes, shapes, testers):
        self.clock, self.nodes, self.shapes, self.testers = clock, nodes, shapes, testers
        self.events, self.turn = [], 0

    def add(self, at, ray):
        self.turn += 1
        heapq.heappush(self.events, (at, self.turn, ray))
        self.clock.wake(at)

    def begin(self, visit, now):
        for i, ray in enumerate(visit.rays):
            at = self.testers.read(now, 1 + (visit.extra_reads if i == 0 else 0))
            if at > now:
                self.add(at, ray)
            else:
                self.advance(ray, now)

    def advance(self, ray, now):
        if ray.at == len(ray.steps):
            ray.visit.left -= 1
            return
        if ray.visit.loaded:
            return self.test(ray, now)
        number, counts = ray.steps[ray.at]
        treelet = self.nodes[number].treelet
        need = [tuple(treelet[:2]) if treelet else self.nodes[number].strip]
        if counts.transforms > 0:
            need.append(self.nodes[number].transform)
        if self.shapes.take(ray.user, need, now):
            self.test(ray, now)

    def test(self, ray, now):
        number, counts = ray.steps[ray.at]
        ray.at += 1
        at = now
        if counts.inversions > 0:
            instance = self.nodes[number].instance
            if instance not in ray.visit.inverted:
                ray.visit.inverted[instance] = self.testers.invert(now, counts.inversion_passes())
            at = max(now, ray.visit.inverted[instance])
        ray.in_test = True
        self.add(self.testers.ray(at, counts, inverts=False), ray)

    def run(self, now, others):
        """Rays whose events have come go on; contexts whose data has come are appended to `others`."""
        self.serve(now, others)
        while self.events and self.events[0][0] <= now:
            ray = heapq.heappop(self.events)[2]
            if ray.in_test:
                ray.in_test = False
                if self.nodes[0].treelet and ray.at < len(ray.steps):
                    self.test(ray, now)
                    continue
                if not ray.visit.loaded:
                    self.shapes.release(ray.user, now)
            self.advance(ray, now)
            self.serve(now, others)

    def serve(self, now, others):
        while self.shapes.ready:
            ready, self.shapes.ready = self.shapes.ready, []
            for user in ready:
                if isinstance(user.owner, Visitor):
                    self.test(user.owner, now)
                else:
                    others.append(user.owner)
