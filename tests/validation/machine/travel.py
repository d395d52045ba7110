"""New rays that travel in packets to find slots ("Rays that travel")."""
from collections import deque

from .clock import ceil_div


class Group:
    """New rays without slots."""

    def __init__(self, rays, addresses):
        self.rays, self.addresses = rays, addresses


class Sender:
    """The part of ray control that sends groups on their way."""

    def __init__(self, config, record, controls):
        self.placement, self.local = config["rays"]["placement"], config["collections"]["home"] == "local"
        self.resources, self.group = config["topology"]["resources"], config["packets"]["rays"]
        slots = config["rays"]["slots_per_resource"]
        self.free = [slots] * self.resources if self.placement == "addressed" else [slots * self.resources]
        self.slots = list(self.free)
        self.record, self.controls = record, controls
        self.turn, self.load_free = 0, [0] * self.resources
        self.waiting = deque()

    def completed(self, resource, rays):
        self.free[resource if self.placement == "addressed" else 0] += len(rays)

    def submit(self, rays):
        groups = []
        for first in range(0, len(rays), self.group):
            batch = rays[first:first + self.group]
            issuer = self.turn % self.resources
            self.turn += 1
            addresses = None
            if self.placement == "addressed":
                step = [0 if self.local else i * self.resources // len(batch) for i in range(len(batch))]
                addresses = [(issuer + s) % self.resources for s in step]
            groups.extend((issuer, part) for part in self.parts(batch, addresses))
        self.waiting.extend(sorted(groups, key=lambda group: group[0]))

    def parts(self, rays, addresses):
        """A group, cut before each ray for which there are not enough slots in all."""
        first, left = 0, list(self.slots)
        for i in range(len(rays)):
            at = addresses[i] if addresses else 0
            if left[at] == 0:
                yield Group(rays[first:i], addresses and addresses[first:i])
                first, left = i, list(self.slots)
            left[at] -= 1
        yield Group(rays[first:], addresses and addresses[first:])

    def send(self, now):
        while self.waiting:
            issuer, group = self.waiting[0]
            wanted = group.addresses or [0] * len(group.rays)
            if any(wanted.count(r) > self.free[r] for r in set(wanted)):
                return
            for r in wanted:
                self.free[r] -= 1
            self.waiting.popleft()
            self.load_free[issuer] = max(self.load_free[issuer], now) + self.record * len(group.rays)
            control = self.controls[issuer]
            control.new_rays.send(self.load_free[issuer] - 1 + control.latency, group)


class Travel:
    """The part of a Tile that sends records round and gives out slots."""

    def start_travel(self, config):
        self.travel = config["rays"]["placement"] in ("first_taker", "addressed")
        self.local_home = config["collections"]["home"] == "local"
        self.slots = list(range(config["rays"]["slots_per_resource"] - 1, -1, -1))
        self.groups, self.due, self.rays_load_free = deque(), deque(), 0

    def send_new_rays(self, now):
        if not self.groups:
            return False
        if not self.resource.idle() and self.resource.in_flight == 0 and not self.issue:
            return False
        d = self.next_free()
        if d is None:
            return False
        packet, travels = self.free[d][-1], self.topology.resources > 1
        packet.memberships, packet.owners, packet.rays = False, set(range(self.topology.resources)), []
        if travels:
            out = self.way_out(packet)
            if not out.has_place() or (self.bubble and out.spare_places() < 2):
                return False
        self.free[d].pop()
        self.turn = (d + 1) % len(self.free)
        group = self.groups.popleft()
        self.dispatch(now, len(group.rays))
        packet.records = list(zip(group.rays, group.addresses or [None] * len(group.rays)))
        packet.left = self.topology.resources - 1
        loaded = self.take_slots(packet, now)
        if travels and packet.records:
            self.depart(packet, max(self.dispatch_free, loaded))
        else:
            self.rays_home(packet, now)
        return True

    def handle_rays(self, port, out, packet, now):
        if packet.owner == self.number:
            port.take(now)
            self.dispatch(now, len(packet.records) + len(packet.rays))
            self.rays_home(packet, now)
            return True
        if not out.has_place():
            return False
        port.take(now)
        self.dispatch(now, len(packet.records))
        loaded = self.take_slots(packet, now)
        self.depart(packet, max(self.dispatch_free, loaded))
        return True

    def take_slots(self, packet, now):
        share = len(packet.records)
        if share and packet.records[0][1] is None:
            share = ceil_div(share, packet.left + 1)
        packet.left = max(0, packet.left - 1)
        taken, rest = [], []
        for ray, address in packet.records:
            if len(taken) < share and address in (None, self.number) and self.slots:
                ray.owner, ray.slot, ray.pending = self.number, self.slots.pop(), self.machine.initial_tests
                taken.append(ray)
            else:
                rest.append((ray, address))
        packet.records = rest
        if not taken:
            return now
        self.trace.note(now, self.number, "place", 0, len(taken))
        self.rays_load_free = max(self.rays_load_free, now) + self.control.record * len(taken)
        if self.local_home:
            self.ids_due(self.rays_load_free, taken)
        else:
            packet.rays.extend(taken)
        return self.rays_load_free

    def ids_due(self, at, rays):
        self.due.append((at, rays))
        self.clock.wake(at)

    def rays_home(self, packet, now):
        loaded = self.take_slots(packet, now)
        if packet.rays:
            self.ids_due(max(loaded, self.due[-1][0] if self.due else 0), packet.rays)
        if packet.records:
            addressed = packet.records[0][1] is not None
            self.groups.append(Group([ray for ray, _ in packet.records],
                                     [address for _, address in packet.records] if addressed else None))
        packet.rays, packet.records = [], None
        self.free[packet.direction].append(packet)

    def rays_loaded(self, now):
        any_loaded = False
        while self.due and self.due[0][0] <= now:
            self.admission.append(self.due.popleft()[1])
            any_loaded = True
        return any_loaded
