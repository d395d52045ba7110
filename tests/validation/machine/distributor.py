"""Testers behind a distributor ("A distributor in front of testers")."""
from collections import Counter

from .clock import ceil_div


class Distributor:
    def __init__(self, config, new_banks):
        d = config["testers"]["distributor"]
        self.count, self.ids, self.places = d["testers"], d["ids_per_cycle"], d["queue"]
        self.ahead, self.decisions, self.result_places = d["out_of_order"], d["results_per_cycle"], d["results"]
        self.latency = config["topology"]["link"]["latency_cycles"]
        self.width = config["topology"]["link"]["bytes_per_cycle"]
        self.banks = [new_banks() for _ in range(self.count)]
        self.starts = [[] for _ in range(self.count)]   # of each tester, ray by ray
        self.decided = [[] for _ in range(self.count)]  # likewise
        self.free_at, self.answered = [0] * self.count, [0] * self.count
        self.bus_free = self.hand_out = 0
        self.taken = Counter()  # results by the cycle in which the decision point takes them
        self.done = []          # packet by packet: it and all older ones have been decided

    def test(self, at, slots, passes, inversions, shape_bytes):
        """The cycles in which the results of a packet go on. `passes`: of each kind of unit for all its rays."""
        self.bus_free = max(at, self.bus_free) + ceil_div(shape_bytes, self.width)
        shapes = self.bus_free + self.latency
        number = len(self.done)
        turn = self.done[number - 1 - self.ahead] + self.latency if number > self.ahead else 0
        self.hand_out = max(at, self.hand_out)
        out, left = [], 0
        for i, slot in enumerate(slots):
            t = slot % self.count
            if left == self.ids:
                self.hand_out, left = self.hand_out + 1, 0
            if len(self.starts[t]) >= self.places:
                place = self.starts[t][-self.places] + self.latency
                if place > self.hand_out:
                    self.hand_out, left = place, 0
            left += 1
            start = max(self.hand_out + self.latency + 1, shapes, self.free_at[t], turn)
            if len(self.decided[t]) >= self.result_places:
                start = max(start, self.decided[t][-self.result_places] + self.latency)
            self.starts[t].append(start)
            self.answered[t] = max(self.answered[t], self.tests_of_ray(t, start, i, len(slots), passes, inversions))
            decision = max([self.answered[t] + self.latency] + self.decided[t][-1:])
            while self.taken[decision] == self.decisions:
                decision += 1
            self.taken[decision] += 1
            self.decided[t].append(decision)
            out.append(decision + 1)
        self.hand_out += 1
        self.done.append(max(self.done[-1:] + out))
        return out

    def tests_of_ray(self, t, start, ray, rays, passes, inversions):
        share = {kind: n // rays + (ray < n % rays) for kind, n in passes.items()}
        at, banks = start, self.banks[t]
        if ray == 0 and inversions > 0:
            at = banks["transform"].reserve(start, inversions)[1]
        begun = at
        at = banks["transform"].reserve(at, share["transform"])[1]
        answer = max(banks[kind].reserve(at, share[kind])[1] for kind in ("box", "triangle", "procedural"))
        self.free_at[t] = max([start + 1, begun] + [bank.free_at for bank in banks.values()])
        return answer
