"""Banks of test units ("Testers")."""
from collections import Counter

from .clock import ceil_div
from .distributor import Distributor

BOX, TRIANGLE, PLANE, BUNDLE, TRANSFORM, PROCEDURAL, ANY_HIT = (
    "box", "triangle", "plane", "bundle", "transform", "procedural", "any_hit_unit")
KINDS = (BOX, TRIANGLE, PLANE, BUNDLE, TRANSFORM, PROCEDURAL, ANY_HIT)
INVERSION_PASSES = 2
FULL_INVERSION_PASSES = 3
DOUBLE_PASSES = 4


class Counts:
    """The tests of a visit."""

    __slots__ = ("box", "triangle", "refined", "procedural", "transforms", "in_double", "inversions", "full_inversions")

    def __init__(self):
        for name in self.__slots__:
            setattr(self, name, 0)

    def add(self, other):
        for name in self.__slots__:
            setattr(self, name, getattr(self, name) + getattr(other, name))

    def passes(self, kind):
        if kind == TRANSFORM:
            return self.transforms + (DOUBLE_PASSES - 1) * self.in_double
        if kind == TRIANGLE:
            return self.triangle + DOUBLE_PASSES * self.refined
        return getattr(self, kind, 0)

    def inversion_passes(self):
        passes = INVERSION_PASSES * self.inversions
        passes += (FULL_INVERSION_PASSES - INVERSION_PASSES) * self.full_inversions
        return passes * (DOUBLE_PASSES if self.in_double else 1)


class Bank:
    def __init__(self, units, interval, latency):
        self.units, self.interval, self.latency = units, interval, latency
        self.free_at = self.spare = 0

    def reserve(self, at, tests):
        """The first and the last answer to tests that start at `at`, or as soon as the bank is free."""
        if tests == 0:
            return at, at
        start = max(at, self.free_at)
        rounds = ceil_div(tests, self.units)
        self.free_at = start + rounds * self.interval
        self.spare = rounds * self.units - tests
        return start + self.latency, self.free_at - self.interval + self.latency

    def reserve_beside(self, at, tests):
        """For a single ray: units left idle by the last start are taken first. The last answer."""
        last_start = self.free_at - self.interval
        if tests == 0 or self.spare == 0 or at > last_start:
            return self.reserve(at, tests)[1]
        beside = min(tests, self.spare)
        self.spare -= beside
        if beside == tests:
            return last_start + self.latency
        return self.reserve(at, tests - beside)[1]


class Testers:
    def __init__(self, config, resource):
        t = config["testers"]
        for one in config["topology"].get("overrides", []):
            if one["resource"] == resource:
                t = one["testers"]
        accuracy = config["accuracy"]
        longer = {TRIANGLE: accuracy["triangle"] in ("double", "exact"), BOX: accuracy["box"] == "double",
                  TRANSFORM: accuracy["transform"] == "two_step_double"}
        new_banks = lambda: {k: Bank(t[k]["units"], t[k]["interval_cycles"] * (DOUBLE_PASSES if longer.get(k) else 1),
                                     t[k]["latency_cycles"]) for k in KINDS}
        self.banks = new_banks()
        central = config["topology"]["shape"] == "central"
        form = config["topology"].get("form", "cells")
        self.distributor = Distributor(config, new_banks) if central and form == "distributor" else None
        self.simd, self.window = t["simd"], t["window"]
        self.reads_per_cycle = config["rays"]["reads_per_cycle"]
        self.store = Bank(max(1, self.reads_per_cycle), 1, 1)
        self.ray_banks, self.primitive_store = config["rays"]["banks"], Bank(1, 1, 1)
        self.cells = self.simd["lanes"] if central and form == "cells" else 0

    def vectors(self, tests, rays, slots=()):
        """Starts of units with lanes: a vector of rays against a shape, or of shapes against a ray."""
        lanes = self.simd["lanes"]
        if lanes == 1 or tests == 0:
            return tests
        rays = max(1, min(rays, tests))
        shapes = ceil_div(tests, rays)
        if self.simd["map"] == "rays":
            return max(ceil_div(rays, lanes), min(rays, self.most(slots, self.cells))) * shapes
        return rays * ceil_div(shapes, lanes)

    @staticmethod
    def most(slots, places):
        """The most of these slots that share one of the places, which hold slots in turn."""
        return max(Counter(slot % places for slot in slots).values(), default=0) if places else 0

    def _reads(self, at, reads, slots, counts):
        if self.ray_banks:
            primitives = counts.triangle > 0 or counts.procedural > 0
            ports = [self.primitive_store] if primitives else []
            if counts.box > 0 or not primitives:
                ports.append(self.store)
            read = [port.reserve(at, self.most(slots, self.ray_banks)) for port in ports]
            return max(first for first, _ in read), max(last for _, last in read)
        return self.store.reserve(at, reads if self.reads_per_cycle > 0 else 0)

    @staticmethod
    def _behind(bank, before, tests):
        """Tests of rays that come one after another from the bank before."""
        if tests == 0:
            return before
        first, last = bank.reserve(before[0], tests)
        return first, max(last, before[1] + bank.latency) if before[1] > before[0] else last

    def strip(self, at, counts, slots):
        reads = len(slots)
        first, last = self._reads(at, reads, slots, counts)
        inverse = self.banks[TRANSFORM].reserve(first, counts.inversion_passes())[1]
        moved = self._behind(self.banks[TRANSFORM], (inverse, max(inverse, last)),
                             self.vectors(counts.passes(TRANSFORM), reads, slots))
        end = self._behind(self.banks[BOX], moved, self.vectors(counts.box, reads, slots))[1]
        for kind in (TRIANGLE, PROCEDURAL):
            end = max(end, self._behind(self.banks[kind], moved, self.vectors(counts.passes(kind), reads, slots))[1])
        return end + (self.simd["reformat_cycles"] if self.simd["lanes"] > 1 else 0)

    def distribute(self, at, counts, slots, shape_bytes):
        passes = {kind: counts.passes(kind) for kind in (BOX, TRIANGLE, TRANSFORM, PROCEDURAL)}
        return self.distributor.test(at, slots, passes, counts.inversion_passes(), shape_bytes)

    def read(self, at, records):
        return self.store.reserve_beside(at, records) if self.reads_per_cycle > 0 else at

    def invert(self, at, passes):
        return self.banks[TRANSFORM].reserve(at, passes)[1]

    def ray(self, at, counts, inverts):
        """The last answer to the tests of a single ray."""
        bank = self.banks
        if inverts and counts.inversions > 0:
            at = self.invert(at, counts.inversion_passes())
        moved = bank[TRANSFORM].reserve_beside(at, self.vectors(counts.passes(TRANSFORM), 1))
        return max(moved, bank[BOX].reserve_beside(moved, self.vectors(counts.box, 1)),
                   bank[TRIANGLE].reserve_beside(moved, self.vectors(counts.passes(TRIANGLE), 1)),
                   bank[PROCEDURAL].reserve_beside(moved, self.vectors(counts.procedural, 1)))
