"""Opacity micromaps a second time, from docs/how-it-works/fewer-tests.md: each micro-triangle is laid over the alpha texture,
and the texels under it say which states it may have."""
import math

TRANSPARENT, OPAQUE, UNKNOWN = 0, 1, 2
ALL = {0xffffffff: TRANSPARENT, 0xfffffffe: OPAQUE, 0xfffffffd: UNKNOWN}
NO_INDEX = 0xfffffffc
NEAR = 1e-3  # of a texel: nearer than this to a border of texels rounding may decide


class Texture:
    """Alpha by glTF 2.0, 3.8: (0, 0) is the corner of the first texel, whose middle is at half a texel."""

    def __init__(self, alpha, wrap, linear):
        self.alpha, self.wrap, self.linear = alpha, wrap, linear
        self.size = (len(alpha[0]), len(alpha))

    def place(self, i, axis):
        size = self.size[axis]
        if self.wrap[axis] == "clamp":
            return min(max(i, 0), size - 1)
        turn, at = divmod(i, size)
        return size - 1 - at if self.wrap[axis] == "mirror" and turn % 2 else at

    def texel(self, x, y):
        return self.alpha[self.place(y, 1)][self.place(x, 0)]

    def texels_of(self, cell):
        """Those that a lookup in a cell reads; cells of filtered lookups lie between the middles of texels."""
        x, y = cell
        return [self.texel(x + dx, y + dy) for dx in (0, 1) for dy in (0, 1)] if self.linear else [self.texel(x, y)]

    def shift(self):
        return 0.5 if self.linear else 0.0

    def lookup(self, x, y):
        x, y = x - self.shift(), y - self.shift()
        i, j = math.floor(x), math.floor(y)
        if not self.linear:
            return self.texel(i, j)
        right, down = x - i, y - j
        above = self.texel(i, j) * (1 - right) + self.texel(i + 1, j) * right
        below = self.texel(i, j + 1) * (1 - right) + self.texel(i + 1, j + 1) * right
        return above * (1 - down) + below * down


def micro_triangles(level):
    """Corners (u, v), row by row of rising v, in turn with the corner and with the side towards v = 1."""
    side = 2 ** level
    for v in range(side):
        for u in range(side - v):
            yield [(u / side, v / side), ((u + 1) / side, v / side), (u / side, (v + 1) / side)]
            if u + v + 1 < side:
                yield [((u + 1) / side, v / side), ((u + 1) / side, (v + 1) / side), (u / side, (v + 1) / side)]


def overlaps(triangle, cell, more):
    """Whether the triangle meets a cell of one texel that is larger by `more` on each side: no line parallel to a side of
    either parts them (S. Gottschalk, OBBTree, 1996)."""
    square = [(cell[0] + x, cell[1] + y) for x in (-more, 1 + more) for y in (-more, 1 + more)]
    ways = [(1, 0), (0, 1)] + [(a[1] - b[1], b[0] - a[0]) for a, b in zip(triangle, triangle[1:] + triangle[:1])]
    for x, y in ways:
        ours, theirs = ([x * p + y * q for p, q in corners] for corners in (triangle, square))
        if max(ours) < min(theirs) or max(theirs) < min(ours):
            return False
    return True


def allowed(texture, corners, least):
    """States that a micro-triangle over these texture coordinates, in texels, may have: `least` is the least solid alpha."""
    shift = texture.shift()
    triangle = [(x - shift, y - shift) for x, y in corners]
    low, high = ([math.floor(f(c[axis] for c in triangle) + side * NEAR) for axis in (0, 1)]
                 for f, side in ((min, -1), (max, 1)))
    sure, perhaps = set(), set()
    for x in range(low[0], high[0] + 1):
        for y in range(low[1], high[1] + 1):
            if overlaps(triangle, (x, y), NEAR):
                kinds = {OPAQUE if alpha >= least else TRANSPARENT for alpha in texture.texels_of((x, y))}
                perhaps |= kinds
                if overlaps(triangle, (x, y), -NEAR):
                    sure |= kinds
    if len(perhaps) == 1:
        return perhaps
    return {UNKNOWN} if len(sure) == 2 else sure | {UNKNOWN}


def state_in(maps, number, micro):
    at = number * 4 ** maps["level"] + micro
    return maps["states"][at // 4] >> 2 * (at % 4) & 3


class Laid:
    """A triangle over the texture: the states that each of its micro-triangles may have, and points of each with alpha."""

    def __init__(self, level, coordinates, texture, least, random):
        def at(u, v):
            return [texture.size[axis] * (coordinates[0][axis] * (1 - u - v) + coordinates[1][axis] * u +
                                          coordinates[2][axis] * v) for axis in (0, 1)]
        micros = list(micro_triangles(level))
        self.may = [allowed(texture, [at(u, v) for u, v in corners], least) for corners in micros]
        self.points = [[self.within(corners, random) for _ in range(2)] for corners in micros]
        self.solid = [[texture.lookup(*at(u, v)) >= least for u, v in points] for points in self.points]
        self.known = sum(len(states) == 1 for states in self.may)

    @staticmethod
    def within(corners, random):
        weights = [random.random() + 0.01 for _ in corners]
        return tuple(sum(w * corner[axis] for w, corner in zip(weights, corners)) / sum(weights) for axis in (0, 1))


def check(maps, mesh, triangle, laid, four):
    """What is wrong with the map of a triangle, or nothing."""
    entry, count = maps["entries"][maps["first_of"][mesh] + triangle], 4 ** maps["level"]
    if entry == NO_INDEX:
        return "no index"
    if entry in ALL:
        found = [ALL[entry]] * count
        if not four and ALL[entry] == UNKNOWN:
            return None if any(UNKNOWN in states for states in laid.may) else "unknown for nothing"
    else:
        found = [state_in(maps, entry, i) for i in range(count)]
        if len(set(found)) == 1 or (not four and UNKNOWN in found):
            return f"a map of the states {set(found)}"
    for i, (state, states, points, solid) in enumerate(zip(found, laid.may, laid.points, laid.solid)):
        if state not in states:
            return f"micro-triangle {i} is {state} instead of one of {states}"
        if state != UNKNOWN and any((state == OPAQUE) != stops for stops in solid):
            return f"micro-triangle {i} is {state}, and not so at one of {points}"
    return None
