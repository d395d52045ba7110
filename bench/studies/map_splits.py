"""The best splits for the map of bench/studies/when_it_pays. `area.fit: best` divides the area of each kind of machine between
its parts, for each width of memory on some frames, and for cycles. Each row of the map takes the machine that is best on its
first seed, of those that were found for its kind and width of memory: one for speed, one for rays a joule."""
import itertools

from map_machines import AIMS, KINDS, LISTS, speed, the_run

FITTED = ("topology.resources", "memory.l2_kib", "memory.l2_lines_per_cycle", "shading.workers", "testers.box.units",
          "testers.triangle.units")


def search(grid, kind, slots, scene, triangles, channels, rays, more=()):
    return the_run(grid, kind, [*KINDS[kind].settings(slots), "area.fit=best"], scene, triangles, channels, rays, grid.seeds[0], more)


def machine_of(kind, slots, fitted):
    """What a search has found, as keys."""
    return [*KINDS[kind].settings(slots), "area.fit=refuse", *(f"{key}={fitted[key]}" for key in FITTED if key in fitted)]


class Splits:
    def __init__(self, runs, grid):
        self.runs, self.grid, self.found = runs, grid, {}

    def search(self, kind, slots, channels, searched):
        scene, rays, triangles = searched
        return search(self.grid, kind, slots, scene, triangles, channels, rays)

    def first(self, kind, channels):
        """On the first frame, by slots: all of them are tried."""
        return {slots: self.search(kind, slots, channels, self.grid.searched[0]) for slots in KINDS[kind].slots}

    def slots(self, kind, channels):
        """Those that were best there."""
        found = self.first(kind, channels)
        return max(found, key=lambda slots: speed(self.runs.read(found[slots])))

    def searches(self, kind, channels):
        """All of them: the slots and the run."""
        slots = self.slots(kind, channels)
        return [*self.first(kind, channels).items(),
                *((slots, self.search(kind, slots, channels, searched)) for searched in self.grid.searched[1:])]

    def machines(self, kind, cell):
        """Those that a row tries: of rays from lists all, of pictures those with the slots that are best on a picture."""
        _, _, channels, rays = cell
        if (kind, channels) not in self.found:
            self.found[kind, channels] = [(slots, machine_of(kind, slots, self.runs.read(run)["fitted"]))
                                          for slots, run in self.searches(kind, channels)]
        best = self.slots(kind, channels)
        some = [tuple(machine) for slots, machine in self.found[kind, channels] if rays in LISTS or slots == best]
        return [list(machine) for machine in dict.fromkeys(some)]

    def trial(self, kind, machine, cell):
        return the_run(self.grid, kind, machine, *cell, self.grid.seeds[0])

    def best(self, aim, kind, cell):
        return max(self.machines(kind, cell), key=lambda machine: AIMS[aim](self.runs.read(self.trial(kind, machine, cell))))

    def stages(self, cells):
        """Yields what is to be run, as soon as what it yielded before is kept."""
        everything = list(itertools.product(KINDS, self.grid.channels))
        yield "first searches", [run for at in everything for run in self.first(*at).values()]
        yield "searches", [run for at in everything for _, run in self.searches(*at)]
        yield "trials", [self.trial(kind, machine, cell) for kind, cell in itertools.product(KINDS, cells)
                         for machine in self.machines(kind, cell)]
