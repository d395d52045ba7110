"""Tuning for the map of bench/studies/when_it_pays: each kind of machine gets the settings that are best for it, with each
scene, kind of rays, size of tree and width of memory: of speed where areas are equal, and of rays a joule where energies are."""
import itertools

from map_machines import AIMS, CONVENTIONAL, KINDS, TRAVELS, TUNED_ON, settings, speed, the_run
from marked_tables import markdown

RIVAL = 0.8  # of the best machine of its side: what is slower is tuned no further


def untuned(grid):
    """The first settings, and those by which runs are counted before the best are known."""
    return {(aim, frame, kind, triangles, channels): settings(kind, grid)[0] for aim in AIMS for frame in grid.frames
            for kind in KINDS for triangles in grid.triangles for channels in grid.channels}


def slots(machine):
    return next(int(key.split("=")[1]) for key in machine if key.startswith("rays.slots_per_resource="))


def tries(runs, grid):
    """Yields which settings are tried of each kind of machine, frame, size and width of memory, as soon as what it yielded
    before is kept. On one frame these are all, on others the best of that one, and from there on those with the next fewer
    and the next more slots, until none of them is faster."""
    places = list(itertools.product(grid.triangles, grid.channels))
    tried = {(TUNED_ON, kind, *at): set(range(len(settings(kind, grid)))) for at in places for kind in KINDS}
    yield tried
    rest = list(itertools.product([frame for frame in grid.frames if frame != TUNED_ON], places))
    tried |= {(frame, kind, *at): {best_of(runs, grid, tried, value, (TUNED_ON, kind, *at)) for value in AIMS.values()}
              for frame, at in rest for kind in KINDS}
    while True:
        yield tried
        found = {where: best_of(runs, grid, tried, speed, where) for where in tried}
        more = {(frame, kind, *at): next_to(kind, grid, found[frame, kind, *at]) for frame, at in rest
                for kind in rivals({kind: speed(runs.read(tuning_run(grid, (frame, kind, *at), found[frame, kind, *at])))
                                    for kind in KINDS})}
        if all(add <= tried[where] for where, add in more.items()):
            return
        tried |= {where: tried[where] | add for where, add in more.items()}


def rivals(speeds):
    """Kinds that may become the best of their side. The ring that travels is always one: the page asks for it."""
    sides = [[kind for kind in KINDS if (kind in CONVENTIONAL) == side] for side in (True, False)]
    return [kind for side in sides for kind in side
            if kind == TRAVELS or speeds[kind] >= RIVAL * max(speeds[other] for other in side)]


def next_to(kind, grid, index):
    """Of a kind's settings, those with the next fewer and the next more slots."""
    order = sorted(range(len(settings(kind, grid))), key=lambda i: slots(settings(kind, grid)[i]))
    at = order.index(index)
    return set(order[max(at - 1, 0):at + 2])


def tuning_run(grid, where, index):
    (scene, rays), kind, triangles, channels = where
    return the_run(grid, kind, settings(kind, grid)[index], scene, triangles, channels, rays, grid.seeds[0])


def best_of(runs, grid, tried, value, where):
    return max(sorted(tried[where]), key=lambda index: value(runs.read(tuning_run(grid, where, index))))


def tune(runs, grid, do=False):
    """The runs for tuning, as far as they are known, and if all are kept the best settings of each kind of machine by aim,
    frame, triangles and channels. `do`: what is missing is done, and none are known only if other shards still tune."""
    if not grid.tunes:
        return [], untuned(grid)
    for tried in tries(runs, grid):
        known = [tuning_run(grid, where, index) for where, some in tried.items() for index in sorted(some)]
        if runs.missing(known) and not (do and runs.do(known)):
            return known, None
    return known, {(aim, *where): settings(where[1], grid)[best_of(runs, grid, tried, value, where)]
                   for aim, value in AIMS.items() for where in tried}


def tuning_table(grid, best):
    rows = [[*frame, f"{triangles:,}", channels, *(short(best["area", frame, kind, triangles, channels], kind) for kind in KINDS)]
            for frame in grid.frames for triangles in grid.triangles for channels in grid.channels]
    return markdown(["scene", "rays", "triangles", "channels", *KINDS], rows)


def short(machine, kind):
    """The settings without those that the kind always has."""
    chosen = [key for key in machine if key not in KINDS[kind][1]]
    return ", ".join(key.rsplit(".", 1)[1].replace("slots_per_resource", "slots").replace("_", " ").replace("=", " ") for key in chosen)
