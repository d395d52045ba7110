"""The best splits for the map of bench/studies/when_it_pays. `area.fit: best` divides the area of each kind of machine between
its parts, for each width of memory on some frames, and for cycles. Each row of the map takes the machine that is best on its
first seed, of those that were found for its kind and width of memory: one for speed, one for rays a joule."""
import itertools

from map_machines import AIMS, CONVENTIONAL, KINDS, LISTS, NEAR, RINGS, TRAVELS, the_run
from map_ratio import fastest

FITTED = ("topology.resources", "memory.l2_kib", "memory.l2_lines_per_cycle", "shading.workers", "testers.box.units",
          "testers.triangle.units")


def search(grid, kind, slots, scene, triangles, channels, rays, more=()):
    return the_run(grid, kind, [*KINDS[kind].settings(slots), "area.fit=best"], scene, triangles, channels, rays, grid.seeds[0], more)


def machine_of(kind, slots, fitted):
    """What a search has found, as keys."""
    return [*KINDS[kind].settings(slots), "area.fit=refuse", *(f"{key}={fitted[key]}" for key in FITTED if key in fitted)]


def slots_of(machine):
    keys = dict(key.split("=", 1) for key in machine)
    return int(keys["rays.slots_per_resource"]) * int(keys["topology.resources"])


class Splits:
    def __init__(self, runs, grid):
        self.runs, self.grid, self.found, self.slots_of = runs, grid, {}, {}

    def search(self, kind, slots, channels, searched):
        scene, rays, triangles = searched
        return search(self.grid, kind, slots, scene, triangles, channels, rays)

    def first(self, kind, channels):
        """On the first frame, by slots: all of them are tried."""
        return {slots: self.search(kind, slots, channels, self.grid.searched[0]) for slots in KINDS[kind].slots}

    def slots(self, aim, kind, channels):
        """Those that were best there."""
        found = self.first(kind, channels)
        return max(found, key=lambda slots: AIMS[aim](self.runs.read(found[slots])))

    def searches(self, kind, channels):
        """All of them: the slots and the run."""
        slots = self.slots("area", kind, channels)
        return [*self.first(kind, channels).items(),
                *((slots, self.search(kind, slots, channels, searched)) for searched in self.grid.searched[1:])]

    def machines(self, aim, kind, cell):
        """Those that a row tries: of rays from lists all, of pictures those with the slots that are best on a picture."""
        _, _, channels, rays = cell
        if (kind, channels) not in self.found:
            self.found[kind, channels] = [(slots, machine_of(kind, slots, self.runs.read(run)["fitted"]))
                                          for slots, run in self.searches(kind, channels)]
        best = self.slots(aim, kind, channels)
        some = [tuple(machine) for slots, machine in self.found[kind, channels] if rays in LISTS or slots == best]
        return [list(machine) for machine in dict.fromkeys(some)]

    def trial(self, kind, machine, cell, seed):
        """On the least picture."""
        return the_run(self.grid, kind, machine, *cell, seed)

    def tried(self, aim, kind, cell):
        return [(AIMS[aim](self.runs.read(self.trial(kind, machine, cell, self.grid.seeds[0]))), machine) for machine in self.machines(aim, kind, cell)]

    def best(self, aim, kind, cell):
        return max(self.tried(aim, kind, cell), key=lambda one: one[0])[1]

    def values(self, aim, cell):
        return {kind: [max(value for value, _ in self.tried(aim, kind, cell))] for kind in KINDS}

    def pair(self, aim, cell):
        """The best conventional kind and the best ring, by the trials."""
        values = self.values(aim, cell)
        return [fastest(CONVENTIONAL, values), fastest(RINGS, values)]

    def compete(self, cell):
        """The kinds that a row measures for speed: on the least picture all, else those near to a pair, and the ring that travels."""
        values = self.values("area", cell)
        best = {kind: max(values[other] for other in kinds) for kinds in (CONVENTIONAL, RINGS) for kind in kinds}
        return [kind for kind in KINDS if kind == TRAVELS or not self.larger(cell) or values[kind][0] > (1 - NEAR) * best[kind][0]]

    def pictured(self, cell):
        """The slots that a row's picture fills: those of the largest machine of a pair."""
        if cell not in self.slots_of:
            self.slots_of[cell] = max(slots_of(self.best(aim, kind, cell)) for aim in AIMS for kind in self.pair(aim, cell))
        return self.slots_of[cell]

    def larger(self, cell):
        """True if that is no longer the least picture."""
        return self.grid.size(cell[3], self.pictured(cell)) != self.grid.size(cell[3], 0)

    def run(self, kind, machine, cell, seed):
        return the_run(self.grid, kind, machine, *cell, seed, slots=self.pictured(cell))

    def stages(self, cells):
        """Yields what is to be run, as soon as what it yielded before is kept."""
        everything = list(itertools.product(KINDS, self.grid.channels))
        yield "first searches", [run for at in everything for run in self.first(*at).values()]
        yield "searches", [run for at in everything for _, run in self.searches(*at)]
        yield "trials", [self.trial(kind, machine, cell, self.grid.seeds[0]) for aim, kind, cell in itertools.product(AIMS, KINDS, cells)
                         for machine in self.machines(aim, kind, cell)]
