"""Tuning for the map of bench/studies/when_it_pays: each kind of machine gets the settings that are best for it, with each size
of tree and width of memory: of speed where areas are equal, and of rays a joule where energies are. All are tried on one
frame, a scene with a kind of rays; from there on those of other rays and scenes are tuned for speed."""
import itertools

from map_machines import AIMS, BOUNCES, CAMERA, CONVENTIONAL, KINDS, SHADOW, TRAVELS, TUNED_ON, settings, speed, the_run
from marked_tables import markdown

AGAIN = (CAMERA, SHADOW, BOUNCES)  # rays for which other frames than the first are tuned for speed too
RIVAL = 0.8  # of the best machine of its side: what is slower is tuned no further
OPEN = 0.85  # of the best conventional machine: where no ring is as fast, other frames than the first are tuned no further
WORTH = 1.01  # what settings must gain over those that are best on the first frame


def untuned(grid):
    """The first settings, and those by which runs are counted before the best are known."""
    return {(aim, frame, kind, triangles, channels): settings(kind, grid)[0] for aim in AIMS for frame in grid.frames
            for kind in KINDS for triangles in grid.triangles for channels in grid.channels}


def slots(machine):
    return next(int(key.split("=")[1]) for key in machine if key.startswith("rays.slots_per_resource="))


def tries(runs, grid):
    """Yields which settings are tried of each kind of machine, frame, size and width of memory, as soon as what it yielded
    before is kept. On one frame these are all, on others the best of that one, and from there on those with the next fewer
    and the next more slots, until none of them gains enough."""
    places = list(itertools.product(grid.triangles, grid.channels))
    tried = {(TUNED_ON, kind, *at): set(range(len(settings(kind, grid)))) for at in places for kind in KINDS}
    yield tried
    rest = list(itertools.product([frame for frame in grid.frames if frame != TUNED_ON], places))
    tried |= {(frame, kind, *at): {best_of(runs, grid, tried, speed, (TUNED_ON, kind, *at))} for frame, at in rest for kind in KINDS}
    while True:
        yield tried
        more = {}
        for frame, at in rest:
            if frame[1] not in AGAIN:
                continue
            found = {kind: best_of(runs, grid, tried, speed, (frame, kind, *at)) for kind in KINDS}
            speeds = {kind: speed(runs.read(tuning_run(grid, (frame, kind, *at), index))) for kind, index in found.items()}
            more |= {(frame, kind, *at): next_to(kind, grid, found[kind]) for kind in rivals(speeds)}
        if all(add <= tried[where] for where, add in more.items()):
            return
        tried |= {where: tried[where] | add for where, add in more.items()}


def rivals(speeds):
    """Kinds that may turn the answer. The ring that travels is always one where any is: the page asks for it."""
    sides = [[kind for kind in KINDS if (kind in CONVENTIONAL) == side] for side in (True, False)]
    stack, ring = (max(speeds[kind] for kind in side) for side in sides)
    return [kind for side, best in zip(sides, (stack, ring), strict=True) for kind in side
            if ring >= OPEN * stack and (kind == TRAVELS or speeds[kind] >= RIVAL * best)]


def next_to(kind, grid, index):
    """Of a kind's settings, those with the next fewer and the next more slots."""
    order = sorted(range(len(settings(kind, grid))), key=lambda i: slots(settings(kind, grid)[i]))
    at = order.index(index)
    return set(order[max(at - 1, 0):at + 2])


def tuning_run(grid, where, index):
    (scene, rays), kind, triangles, channels = where
    return the_run(grid, kind, settings(kind, grid)[index], scene, triangles, channels, rays, grid.seeds[0])


def best_of(runs, grid, tried, value, where):
    """The best of what was tried; on other frames than the first, if it is worth a change."""
    frame, *what = where
    values = {index: value(runs.read(tuning_run(grid, where, index))) for index in sorted(tried[where])}
    best = max(values, key=values.get)
    if frame == TUNED_ON:
        return best
    before = best_of(runs, grid, tried, value, (TUNED_ON, *what))
    return best if values[best] > WORTH * values[before] else before


def tune(runs, grid, do=False):
    """The runs for tuning, as far as they are known, and if all are kept the best settings of each kind of machine by aim,
    frame, triangles and channels. `do`: what is missing is done, and none are known only if other shards still tune."""
    if not grid.tunes:
        return [], untuned(grid)
    for tried in tries(runs, grid):
        known = [tuning_run(grid, where, index) for where, some in tried.items() for index in sorted(some)]
        if runs.missing(known) and not (do and runs.do(known)):
            return known, None
    best = {(aim, *where): best_of(runs, grid, tried, value, where if value == speed else (TUNED_ON, *where[1:]))
            for aim, value in AIMS.items() for where in tried}
    return known, {where: settings(where[2], grid)[index] for where, index in best.items()}


def tuning_table(grid, best):
    """Of each kind the slots, with each width of memory in turn."""
    rows = [[*frame, f"{triangles:,}", *(", ".join(str(slots(best["area", frame, kind, triangles, channels])) for channels in grid.channels)
                                         for kind in KINDS)] for frame in grid.frames for triangles in grid.triangles]
    return markdown(["scene", "rays", "triangles", *KINDS], rows)
