"""A resource with a clock ("A resource in a cycle")."""
from collections import deque

from .clock import Channel, SideWire, ceil_div
from .network import Packet, Token
from .packet_size import PacketSize
from .resource import Resource
from .shape_buffer import ShapeBuffer
from .testers import Testers
from .tile_issue import Issues
from .tile_tests import STARTING, Context, Tests
from .tile_window import Window
from .travel import Travel
from .walk import Visits


class Control:
    """The wires between a resource and ray control with shading."""

    def __init__(self, config, clock):
        link = config["topology"]["link"]
        self.latency = link["latency_cycles"]
        self.record = ceil_div(64, link["bytes_per_cycle"])
        self.ids = SideWire(clock, config, self.latency)
        self.new_rays, self.completed = self.ids.channel, Channel(clock)
        self.questions, self.answers = SideWire(clock, config, self.latency), SideWire(clock, config, self.latency)
        self.free_at = 0

    def ask(self, rays, calls, now):
        """Any-hit calls of rays go to a shader worker."""
        if calls:
            self.questions.send(4 * len(rays) + 16 * len(calls), now, (rays, calls))

    def complete(self, rays, now):
        self.free_at = max(self.free_at, now) + len(rays) * self.record
        self.completed.send(self.free_at + self.latency, rays)


class Tile(Issues, Tests, Travel, Window):
    def __init__(self, number, machine, ports, shapes, control):
        config = machine.config
        self.number, self.machine, self.clock, self.trace = number, machine, machine.clock, machine.trace
        self.nodes, self.topology = machine.nodes, machine.topology
        self.in_ports, self.out_ports = ports
        self.control = control
        self.resource = Resource(number, config, machine.facts, machine.nodes)
        self.testers = Testers(config, number)
        self.shapes = ShapeBuffer(config, shapes)
        self.visits = Visits(self.clock, self.nodes, self.shapes, self.testers)
        self.size = PacketSize(config, machine.nodes)
        self.sizes = {width: PacketSize(config, machine.nodes, width)
                      for width in (self.topology.widths if hasattr(self.topology, "drawing") else [])}
        self.ids_per_cycle = config["packets"]["ids_per_cycle"]
        self.sort_rate = config["collections"]["sort_ids_per_cycle"]
        self.issue_places = config["memory"]["fetch_ahead"] + 1
        self.fetch_by_resource = config["memory"]["fetch"] != "packet"
        self.multicast = config["memory"]["fetch"] == "multicast"
        self.shared_by = config["memory"]["shared_by"]
        self.starts_later = self.fetch_by_resource or self.resource.treelets or config["collections"]["traversal"] == "treelet"
        self.partial = config["collections"]["partial"]
        self.memory_latency = config["memory"]["l2_latency_cycles"] + config["memory"]["dram_latency_cycles"]
        self.graph = hasattr(self.topology, "drawing")
        self.bubble = (self.topology.bubble_holds if self.graph else
                       config["topology"]["flow"] == "bubble" and not self.topology.bus)
        self.stays = config["collections"]["home"] == "local" or self.topology.resources == 1
        self.own_last = config["testers"]["own_rays"] == "after"
        self.central = config["topology"]["shape"] == "central"
        self.forwards = config["testers"].get("distributor", {}).get("stragglers") == "forward"
        self.start_travel(config)
        self.contexts = [Context() for _ in range(config["testers"]["contexts"])]
        each = (config["testers"]["contexts"] + 1 + config["memory"]["fetch_ahead"]
                if self.stays and not (self.travel and self.topology.resources > 1)
                else self.topology.in_flight)
        first = number * self.topology.directions * each
        self.free = [[Packet(first + d * each + i, number, d) for i in range(each)]
                     for d in range(self.topology.directions)]
        self.turn = 0
        self.issue = deque()
        self.admission = deque()
        self.dispatch_free = self.next_in = 0
        self.window, self.passed_over = self.testers.window, [0 for _ in self.in_ports]
        self.done, self.late = [], []

    # ---- a cycle

    def step(self, now):
        for out in self.out_ports:
            out.take_credits(now)
        self.resource.collections.ripen(now)
        self.shapes.take_answers(now)
        self.serve(now)
        for context in self.contexts:
            if context.phase == STARTING and context.at <= now:
                self.start(context, now)
        while self.control.answers.channel.ready(now):
            rays = self.control.answers.channel.take()
            for ray in rays:
                ray.pending -= 1
            self.hand_over([ray for ray in rays if ray.pending == 0])
        while self.control.new_rays.ready(now):
            (self.groups if self.travel else self.admission).append(self.control.new_rays.take())
        again = True
        while again:
            again = self.finish_tests(now)
            again |= self.cut_through(now)
            again |= self.handle(now)
            again |= self.admit(now)
            again |= self.fill_issue(now)
            for out in self.out_ports:
                again |= out.send(now)
        if self.done:
            self.trace.note(now, self.number, "complete", 0, len(self.done))
            self.slots.extend(ray.slot for ray in self.done)
            self.control.complete(self.done, now)
            self.done = []
        if (ripe := self.resource.collections.next_ripe()) is not None:
            self.clock.wake(ripe)

    def reading(self, ids):
        return max(1, ceil_div(ids, self.ids_per_cycle))

    def sort(self, now, joined, entries):
        """Dispatch, which has just read so many entries, goes on until the IDs that join collections are sorted."""
        if self.sort_rate > 0 and ceil_div(joined, self.sort_rate) > self.reading(entries):
            self.dispatch_free = max(self.dispatch_free, now) + ceil_div(joined, self.sort_rate) - self.reading(entries)
            self.clock.wake(self.dispatch_free)

    def dispatch(self, now, ids):
        self.dispatch_free = max(self.dispatch_free, now) + self.reading(ids)
        self.clock.wake(self.dispatch_free)

    def travels(self, packet):
        return not self.stays and self.topology.travels(packet)

    def tests_own_last(self, packet):
        return (self.own_last and not packet.memberships and self.number in packet.owners and
                packet.owner == self.number and self.travels(packet))

    # ---- new rays

    def admit(self, now):
        moved = self.rays_loaded(now)
        while self.admission:
            rays = self.admission[0]
            count = min(len(rays), self.resource.storage.admissible())
            if count == 0:
                break
            self.resource.admit(rays[:count], now)
            self.trace.note(now, self.number, "new_rays", 0, count)
            moved = True
            if count < len(rays):
                self.admission[0] = rays[count:]
            else:
                self.admission.popleft()
        self.write_spilled(now)
        return moved

    # ---- packets on their way

    def way_out(self, packet):
        return self.out_ports[self.topology.port(packet, self.number)]

    def goes_by(self, now):
        """In a graph: packets with another stop, whatever is visited."""
        moved = False
        for port in self.in_ports:
            way = lambda token: self.out_ports[self.topology.port_to(token.stop, self.number, token.packet.direction)]
            while True:
                seen = port.window(now, self.window)
                place = next((i for i, token in enumerate(seen) if token.stop != self.number and
                              (self.window == 1 or way(token).has_place())), None)
                if place is None or not way(seen[place]).has_place():
                    break
                token = port.take(now, place)
                way(token).push(token, now, self.topology.prepare(token, self.number))
                moved = True
        return moved

    def cut_through(self, now):
        moved = False
        if self.graph:
            return self.goes_by(now)
        if self.topology.visit_all or self.topology.bus:
            return moved
        for port, out in zip(self.in_ports, self.out_ports):
            while out.has_place():
                seen = port.window(now, self.window)
                place = next((i for i, token in enumerate(seen) if token.skip > 0), None)
                if place is None:
                    break
                token = port.take(now, place)
                token.skip -= 1
                out.push(token, now, token.skip > 0)
                moved = True
        return moved

    def handle(self, now):
        if self.dispatch_free > now:
            return False
        count = len(self.in_ports)
        for i in range(count):
            d = (self.next_in + i) % count
            if self.choose(d, now) and self.handle_arrival(d, now):
                self.next_in = (d + 1) % count
                return True
        return self.send_new_rays(now) or self.handle_issue(now)

    def handle_arrival(self, d, now):
        port = self.in_ports[d]
        token = port.front()
        packet = token.packet
        if self.graph and token.stop != self.number:
            return False
        out = self.way_out(packet)
        if token.skip > 0:
            if not self.topology.visit_all or not out.has_place():
                return False
            port.take(now)
            token.skip -= 1
            self.dispatch(now, token.entries)
            if self.graph:
                token.stop = self.topology.stop(packet, self.number)
            out.push(token, self.dispatch_free, self.graph and self.topology.prepare(token, self.number))
            return True
        if token.passes:
            port.take(now)
            self.dispatch(now, token.entries)
            return True
        if token.answers:
            own = packet.due == 1 and self.tests_own_last(packet)
            if own and self.free_context() is None:
                return False
            port.take(now)
            self.dispatch(now, token.entries)
            packet.due -= 1
            if packet.due == 0:
                self.test_own(packet, now) if own else self.retire(packet, now, token.entries)
            return True
        if packet.records is not None:
            return self.handle_rays(port, out, packet, now)
        if packet.owner == self.number and self.tests_own_last(packet):
            if self.free_context() is None:
                return False
            port.take(now)
            self.test_own(packet, now)
            return True
        if packet.owner == self.number:
            port.take(now)
            entries = self.read_at_owner(packet)
            self.dispatch(now, entries)
            self.retire(packet, now, entries)
            return True
        if not out.has_place():
            return False
        tested = not packet.memberships and self.number in packet.owners
        context = self.free_context() if tested else None
        if tested and context is None:
            return False
        port.take(now)
        self.trace.note(now, self.number, "take", packet.number, len(packet.rays))
        self.dispatch(now, self.read_on_visit(packet))
        if tested:
            out.reserved += 1
            self.begin_test(context, packet, self.dispatch_free, False)
            return True
        read = self.dispatch_free
        if packet.memberships and packet.home == self.number:
            ids = len(packet.rays)
            self.resource.join(packet, now)
            self.sort(now, ids, ids)
            self.write_spilled(now)
        self.depart(packet, read)
        return True

    def depart(self, packet, ready):
        if self.topology.bus:
            return self.say(packet, ready)
        skip = self.topology.skip(packet, self.number)
        cycles = self.size.cycles(packet, self.is_treelet(packet))
        if self.graph:
            token = Token(packet, skip, cycles, self.read_on_visit(packet))
            token.stop = self.topology.stop(packet, self.number)
            token.sizes = {width: size.cycles(packet, self.is_treelet(packet)) for width, size in self.sizes.items()}
            return self.way_out(packet).push(token, ready, self.topology.prepare(token, self.number))
        self.out_ports[packet.direction].push(Token(packet, skip, cycles, self.read_on_visit(packet)), ready,
                                              not self.topology.visit_all and skip > 0)

    def say(self, packet, ready):
        """To all who hear it, or to the packet's owner the answer for the rays that live here."""
        tests = not packet.memberships and packet.records is None
        treelet = self.is_treelet(packet)
        if tests and packet.owner != self.number:
            members = self.resource.local_members(packet)
            cycles = self.size.answer_cycles(packet, members, treelet)
            token = Token(packet, 0, cycles, self.size.of_answer(packet, members, treelet), True)
        else:
            if tests:
                packet.due = len(packet.owners - {self.number})
            token = Token(packet, 0, self.size.cycles(packet, treelet), self.read_on_visit(packet))
        self.out_ports[0].push(token, ready, False)

    def is_treelet(self, packet):
        return packet.records is None and self.resource.traversal.is_treelet(packet.node)

    def read_on_visit(self, packet):
        return self.size.on_visit(packet, self.is_treelet(packet))

    def read_at_owner(self, packet):
        if self.central and not self.nodes[packet.node].inner:  # past the collections
            return sum(following is not None for following in packet.next)
        return self.size.at_owner(packet, self.is_treelet(packet), self.topology.bus)

    def test_own(self, packet, now):
        """The packet is back, and the rays that its owner has itself come last."""
        self.trace.note(now, self.number, "take", packet.number, len(packet.rays))
        self.dispatch(now, self.read_on_visit(packet))
        self.begin_test(self.free_context(), packet, self.dispatch_free, False)

    def retire_part(self, part, now, entries):
        self.trace.note(now, self.number, "retire", part.number, len(part.rays))
        held = self.resource.collections.memberships()
        self.resource.retire(part, now)
        self.resource.in_flight += 1  # the rest of the packet
        self.sort(now, self.resource.collections.memberships() - held, entries)
        self.write_spilled(now)

    def retire(self, packet, now, entries):
        """Dispatch has read so many entries of it."""
        self.trace.note(now, self.number, "retire", packet.number, len(packet.rays))
        held = self.resource.collections.memberships()
        self.resource.retire(packet, now)
        self.sort(now, self.resource.collections.memberships() - held, entries)
        self.free[packet.direction].append(packet)
        self.write_spilled(now)
