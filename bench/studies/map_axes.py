"""Where a machine stands on the map of bench/studies/when_it_pays, and what the map says of this place. All is told by its
configuration, without a simulation."""
import bisect
import dataclasses
import json
import math
import subprocess
import sys

from marked_tables import ROOT

CHANNEL_BYTES = {"lpddr5_6400": 12.8, "gddr6_14": 28, "hbm2_2": 32}  # of a channel in a cycle of 1 ns


@dataclasses.dataclass(frozen=True)
class Place:
    tree: float  # bytes of the tree for each square millimetre of the budget
    bandwidth: float  # bytes a cycle of memory for each square millimetre

    def logs(self):
        return math.log(self.tree), math.log(self.bandwidth)

    def far(self, other):
        return math.dist(self.logs(), other.logs())


def place_of(program, run):
    """Of the machine of a run, as `carousel check` resolves it."""
    command = [program, "check", ROOT / "configs" / run["config"], "--json"]
    done = subprocess.run([*command, *(word for key in run["keys"] for word in ("--set", key))], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"check {run['config']} {' '.join(run['keys'])}: {done.stderr or done.stdout}")
    told = json.loads(done.stdout)
    dram, area = told["resolved"]["memory"]["dram"], told["resolved"]["area"]["budget_mm2"]
    return Place(told["memory"]["parts"]["structure"] / area, CHANNEL_BYTES[dram["preset"]] * dram["channels"] / area)


def between(points, at):
    """Values on straight lines between points; beyond the ends, those of the ends. A point is a position and its values."""
    points = sorted(points)
    index = bisect.bisect([position for position, _ in points], at)
    if index in (0, len(points)):
        return points[min(index, len(points) - 1)][1]
    (before, low), (after, high) = points[index - 1:index + 1]
    share = (at - before) / (after - before)
    return tuple(a + share * (b - a) for a, b in zip(low, high, strict=True))


def ratio_at(rows, place):
    """What the rows of a map say of a place: first between rows of one tree, by bandwidth, then between trees, all in
    logarithms. `rows`: of each tree and width of memory the place and the ratio."""
    tree, bandwidth = place.logs()
    lines = {}
    for (triangles, _), (stands, ratio) in rows.items():
        x, y = stands.logs()
        lines.setdefault(triangles, []).append((y, (x, math.log(ratio))))
    across = [between(line, bandwidth) for line in lines.values()]
    return math.exp(between([(x, (ratio,)) for x, ratio in across], tree)[0])


def nearest_row(rows, place):
    """The size and width of memory of the row that stands nearest."""
    return min(rows, key=lambda row: rows[row][0].far(place))
