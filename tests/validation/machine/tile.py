"""A resource with a clock ("A resource in a cycle")."""
from collections import deque

from .clock import Channel, ceil_div
from .network import Packet, PacketSize, Token
from .resource import PACKET, Resource
from .shape_buffer import ShapeBuffer, User
from .testers import Testers
from .walk import Visit, Visits

FREE, STARTING, FETCHING, COMPUTING, WALKING = "free", "starting", "fetching", "computing", "walking"


class Context:
    """A packet in test."""

    def __init__(self):
        self.phase, self.packet, self.at, self.tests, self.reads = FREE, None, 0, None, 0
        self.completed, self.visit = [], None
        self.user, self.has_data = User(self), False


class Issue:
    """A packet of the resource's own that waits for its shapes and for dispatch."""

    def __init__(self, packet):
        self.packet, self.user = packet, None
        self.spilled = 0  # spilled blocks that have not come back

    def ready(self):
        return self.spilled == 0 and (self.user is None or self.user.here())


class Control:
    """The wires between a resource and ray control with shading."""

    def __init__(self, config, clock):
        link = config["topology"]["link"]
        self.latency = link["latency_cycles"]
        self.record = ceil_div(64, link["bytes_per_cycle"])
        self.new_rays, self.completed = Channel(clock), Channel(clock)
        self.free_at = 0

    def complete(self, rays, now):
        self.free_at = max(self.free_at, now) + len(rays) * self.record
        self.completed.send(self.free_at + self.latency, rays)


class Tile:
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
        self.ids_per_cycle = config["packets"]["ids_per_cycle"]
        self.issue_places = config["memory"]["fetch_ahead"] + 1
        self.fetch_by_resource = config["memory"]["fetch"] == "resource"
        self.partial = config["collections"].get("partial", "idle")
        self.memory_latency = config["memory"]["l2_latency_cycles"] + config["memory"]["dram_latency_cycles"]
        self.bubble = config["topology"]["flow"] == "bubble"
        self.stays = config["collections"]["home"] == "local" or self.topology.resources == 1
        self.contexts = [Context() for _ in range(config["testers"]["contexts"])]
        each = (config["testers"]["contexts"] + 1 + config["memory"]["fetch_ahead"] if self.stays
                else self.topology.in_flight)
        first = number * self.topology.directions * each
        self.free = [[Packet(first + d * each + i, number, d) for i in range(each)]
                     for d in range(self.topology.directions)]
        self.turn = 0
        self.issue = deque()
        self.admission = deque()
        self.dispatch_free = self.next_in = 0
        self.done, self.late = [], []

    # ---- a cycle

    def step(self, now):
        for out in self.out_ports:
            out.take_credits(now)
        ripe = self.resource.collections.ripen(now)
        if ripe is not None:
            self.clock.wake(ripe)
        self.shapes.take_answers(now)
        self.serve(now)
        for context in self.contexts:
            if context.phase == STARTING and context.at <= now:
                self.start(context, now)
        while self.control.new_rays.ready(now):
            self.admission.append(self.control.new_rays.take())
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
            self.control.complete(self.done, now)
            self.done = []

    def reading(self, ids):
        return max(1, ceil_div(ids, self.ids_per_cycle))

    def dispatch(self, now, ids):
        self.dispatch_free = max(self.dispatch_free, now) + self.reading(ids)
        self.clock.wake(self.dispatch_free)

    def travels(self, packet):
        return not self.stays and self.topology.travels(packet)

    # ---- new rays

    def admit(self, now):
        moved = False
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

    def cut_through(self, now):
        moved = False
        if self.topology.visit_all:
            return moved
        for port, out in zip(self.in_ports, self.out_ports):
            while port.ready(now) and port.front().skip > 0 and out.has_place():
                token = port.take(now)
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
            if self.in_ports[d].ready(now) and self.handle_arrival(d, now):
                self.next_in = (d + 1) % count
                return True
        return self.handle_issue(now)

    def handle_arrival(self, d, now):
        port, out = self.in_ports[d], self.out_ports[d]
        token = port.front()
        packet = token.packet
        if token.skip > 0:
            if not self.topology.visit_all or not out.has_place():
                return False
            port.take(now)
            token.skip -= 1
            self.dispatch(now, len(packet.rays))
            out.push(token, self.dispatch_free, False)
            return True
        if packet.owner == self.number:
            port.take(now)
            self.dispatch(now, len(packet.rays))
            self.retire(packet, now)
            return True
        if not out.has_place():
            return False
        tested = not packet.memberships and self.number in packet.owners
        context = self.free_context() if tested else None
        if tested and context is None:
            return False
        port.take(now)
        self.trace.note(now, self.number, "take", packet.number, len(packet.rays))
        self.dispatch(now, len(packet.rays))
        if tested:
            out.reserved += 1
            self.begin_test(context, packet, self.dispatch_free, False)
            return True
        if packet.memberships and packet.home == self.number:
            self.resource.join(packet, now)
            self.write_spilled(now)
        self.depart(packet, self.dispatch_free)
        return True

    def depart(self, packet, ready):
        skip = self.topology.skip(packet, self.number)
        cycles = self.size.cycles(packet, self.resource.traversal.is_treelet(packet.node))
        self.out_ports[packet.direction].push(Token(packet, skip, cycles), ready,
                                              not self.topology.visit_all and skip > 0)

    def retire(self, packet, now):
        self.trace.note(now, self.number, "retire", packet.number, len(packet.rays))
        self.resource.retire(packet, now)
        self.free[packet.direction].append(packet)
        self.write_spilled(now)

    # ---- spilled collections

    def spill_span(self, move):
        number, first, ids = move
        block = 12 + 4 * self.resource.collections.block
        return (self.number + 1 << 40) + number * block + 4 * first, 12 + 4 * ids

    def write_spilled(self, now):
        written, self.resource.collections.written = self.resource.collections.written, []
        for move in written:
            self.shapes.port.request(self.spill_span(move), None, now)

    def read_spilled(self, issue, now):
        read, self.resource.collections.read = self.resource.collections.read, []
        for move in read:
            self.shapes.port.request(self.spill_span(move), issue, now)
            issue.spilled += 1

    # ---- packets of its own

    def partial_may_go(self, now):
        """Whether a collection that is not ready may go."""
        if self.partial == "idle":
            return (not self.issue and self.dispatch_free <= now and all(c.phase == FREE for c in self.contexts) and
                    not any(port.ready(now) for port in self.in_ports))
        if self.partial == "after":
            return False
        ends = max(self.dispatch_free, now) + sum(self.reading(len(issue.packet.rays)) for issue in self.issue)
        ends = max([ends] + [c.at for c in self.contexts if c.phase == COMPUTING])
        if ends > now + self.memory_latency:
            self.clock.wake(ends - self.memory_latency)
            return False
        return True

    def next_free(self):
        for i in range(len(self.free)):
            d = (self.turn + i) % len(self.free)
            if self.free[d]:
                return d
        return None

    def fill_issue(self, now):
        moved = False
        while len(self.issue) < self.issue_places and not self.resource.idle():
            d = self.next_free()
            if d is None:
                return moved
            packet = self.free[d][-1]
            if self.resource.offer(self.partial_may_go(now), packet, now) != PACKET:
                return moved
            self.free[d].pop()
            self.turn = (d + 1) % len(self.free)
            moved = True
            issue = Issue(packet)
            brings = not self.fetch_by_resource and not self.resource.traversal.is_treelet(packet.node)
            if not packet.memberships and (brings or self.number in packet.owners):
                issue.user = User(issue)
                self.shapes.take_ahead(issue.user, self.shape_data(packet, True), now)
            self.read_spilled(issue, now)
            self.issue.append(issue)
        return moved

    def handle_issue(self, now):
        if not self.issue or not self.issue[0].ready():
            return False
        packet, user = self.issue[0].packet, self.issue[0].user
        travels = self.travels(packet)
        if travels:
            out = self.out_ports[packet.direction]
            if not out.has_place() or (self.bubble and out.spare_places() < 2):
                return False
        tested = not packet.memberships and self.number in packet.owners
        context = self.free_context() if tested else None
        if tested and context is None:
            return False
        self.issue.popleft()
        if user is not None:
            self.shapes.leave_queue()
        self.trace.note(now, self.number, "issue", packet.number, len(packet.rays))
        self.dispatch(now, len(packet.rays))
        if tested:
            if travels:
                self.out_ports[packet.direction].reserved += 1
            if user is not None:
                self.shapes.hand_over(user, context.user)
            self.begin_test(context, packet, self.dispatch_free, user is not None)
        else:
            if user is not None:
                self.shapes.release(user, now)
            self.depart(packet, self.dispatch_free)
        return True

    # ---- tests

    def free_context(self):
        return next((c for c in self.contexts if c.phase == FREE), None)

    def begin_test(self, context, packet, at, has_data):
        members = self.resource.local_members(packet)
        context.packet, context.reads, context.has_data = packet, len(members), has_data
        context.rays = [packet.rays[i] for i in members]
        context.tests = self.resource.test(packet, members)
        context.completed, self.resource.completed[:] = list(self.resource.completed), []
        context.phase, context.at = STARTING, at
        self.clock.wake(at)

    def start(self, context, now):
        """The dispatch stage has read the packet."""
        if self.resource.traversal.is_treelet(context.packet.node):
            context.phase, context.visit = WALKING, Visit(context.tests)
            self.visits.begin(context.visit, now)
            if context.has_data:
                self.shapes.release(context.user, now)
        elif (context.has_data or not self.fetch_by_resource or
              self.shapes.take(context.user, self.shape_data(context.packet, context.tests.transforms > 0), now)):
            self.compute(context, now)
        else:
            context.phase = FETCHING

    def compute(self, context, now):
        context.phase, context.at = COMPUTING, self.testers.strip(now, context.tests, context.reads)
        self.clock.wake(context.at)

    def serve(self, now):
        """Rays in treelets go on, then packets whose data has come take units."""
        ready = []
        self.visits.run(now, ready)
        for context in ready:
            self.compute(context, now)

    def finish_tests(self, now):
        self.serve(now)
        moved = False
        for context in self.contexts:
            ended = (context.visit.left == 0 if context.phase == WALKING
                     else context.phase == COMPUTING and context.at <= now)
            if not ended:
                continue
            moved = True
            packet = context.packet
            self.trace.note(now, self.number, "tested", packet.number, len(packet.rays))
            if context.phase == COMPUTING:
                self.shapes.release(context.user, now)
            context.phase = FREE
            self.hand_over(context.completed)
            if packet.owner == self.number and not self.travels(packet):
                self.dispatch(now, len(packet.rays))
                self.retire(packet, now)
            else:
                self.out_ports[packet.direction].reserved -= 1
                self.depart(packet, now)
        return moved

    def hand_over(self, completed):
        """Those that another visit still tests are kept back."""
        tested = {ray for context in self.contexts if context.phase != FREE for ray in context.rays}
        completed = self.late + completed
        self.done.extend(ray for ray in completed if ray not in tested)
        self.late = [ray for ray in completed if ray in tested]

    def shape_data(self, packet, transform):
        """What the tests of a packet need: its shapes, and what is stored of their instance's transform."""
        node = self.nodes[packet.node]
        return [node.shapes_of(packet.lane)] + ([node.transform] if transform else [])
