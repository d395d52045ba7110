"""The facts of a run: the tree, and the boxes and triangles that each ray meets. They are no part of the model."""


class Node:
    def __init__(self, number, fact):
        self.number = number
        self.key = fact["key"]
        self.inner, self.procedural, self.shapes = fact["inner"], fact["procedural"], fact["shapes"]
        self.children = fact["children"]
        self.triangles_below = fact["triangles_below"]
        self.strip, self.transform = tuple(fact["strip"] + fact["longest"]), tuple(fact["transform"])
        self.moves, self.transposed, self.promoted = fact["moves"], fact["transposed"], fact["promoted"]
        self.instance = self.key >> 32  # the highest number above the instances
        self.treelet = fact.get("treelet")  # of the whole tree: [address, bytes, ways out]
        self.block = fact.get("block")  # [address, bytes, key] of the block of memory in which it begins

    def shapes_of(self, lane):
        """The span of its whole strip, or of one shape of it."""
        if lane is None or lane >= self.shapes:
            return self.strip
        size = 32 if self.inner else 40
        return self.strip[0] + lane * size, size


class Ray:
    """A ray on its way through the machine, and its place there."""

    def __init__(self, fact):
        self.fact = fact
        self.name = tuple(fact["name"])
        self.shadow = fact["shadow"]
        self.boxes, self.triangles, self.candidates = fact["boxes"], fact["triangles"], fact["candidates"]
        self.calls = fact.get("calls", {})
        self.asked = []  # any-hit calls of the present visit
        self.lookups, self.products = fact.get("lookups", 0), fact.get("products", 0)
        self.t = float("inf") if fact["range"] is None else fact["range"]
        self.done = False
        self.pending = 0
        self.owner = self.slot = None
        self.kept = set()  # instances for which its copy in model space is kept
        self.stack = []    # ordered traversal
        self.at = 0, 0     # ... by blocks of memory: its node and that one's depth

    def take_calls(self):
        calls, self.asked = self.asked, []
        return calls

    def meet_boxes(self, node, lanes):
        """The children of `node` that it hits, with its entries: [(lane, entry)]."""
        entries = self.boxes[str(node.number)]
        return [(lane, entries[lane]) for lane in lanes if entries[lane] is not None and entries[lane] <= self.t]

    def meet_triangles(self, node, lanes):
        """The number of triangles whose distance is computed in 64 bits."""
        refined = 0
        for lane in lanes:
            entry = self.candidates[str(node.number)][lane]
            refined += entry is not None and entry <= self.t
            call = self.calls[str(node.number)][lane]
            if call is not None and call["t"] <= self.t:
                self.pending += not self.asked
                self.asked.append(call)
            t = self.triangles[str(node.number)][lane]
            if t is not None and t <= self.t:
                self.t = t
                self.done = self.shadow
        return refined
