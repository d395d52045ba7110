"""The tests of a packet at a resource ("Shapes", "Finish tests")."""
import copy

from .shape_buffer import User
from .walk import Visit

FREE, STARTING, FETCHING, COMPUTING, WALKING = "free", "starting", "fetching", "computing", "walking"


class Context:
    """A packet in test."""

    def __init__(self):
        self.phase, self.packet, self.at, self.tests, self.slots = FREE, None, 0, None, []
        self.completed, self.visit = [], None
        self.user, self.has_data, self.loaded = User(self), False, False


class Tests:
    """The part of a Tile that tests."""

    def free_context(self):
        return next((c for c in self.contexts if c.phase == FREE), None)

    def begin_test(self, context, packet, at, has_data):
        members = self.resource.local_members(packet)
        context.packet, context.slots, context.has_data = packet, [packet.rays[i].slot for i in members], has_data
        context.rays = [packet.rays[i] for i in members]
        context.tests = self.resource.test(packet, members)
        context.asking = [ray for ray in context.rays if ray.asked]
        context.calls = [call for ray in context.asking for call in ray.take_calls()]
        if not self.topology.bus or packet.owner == self.number:
            packet.answered += len(members)
        context.completed, self.resource.completed[:] = list(self.resource.completed), []
        if not self.starts_later:
            return self.compute(context, at)
        context.phase, context.at = STARTING, at
        self.clock.wake(at)

    def start(self, context, now):
        """The dispatch stage has read the packet."""
        if self.resource.traversal.is_treelet(context.packet.node):
            context.loaded = self.resource.treelets and not context.packet.groups
            moved = any(counts.transforms > 0 for steps in context.tests for _, counts in steps)
            if (not context.loaded or context.has_data or
                    self.shapes.take(context.user, self.shape_data(context.packet, moved), now)):
                self.walk(context, now)
            else:
                context.phase = FETCHING
        elif (context.has_data or not self.fetch_by_resource or
              self.shapes.take(context.user, self.shape_data(context.packet, context.tests.transforms > 0), now)):
            self.compute(context, now)
        else:
            context.phase = FETCHING

    def walk(self, context, now):
        """Its rays go through a treelet, each by itself."""
        extra = context.packet.extra_reads if self.resource.treelets else 0
        context.phase, context.visit = WALKING, Visit(context.tests, extra, context.loaded)
        self.visits.begin(context.visit, now)
        if context.has_data and not context.loaded:
            self.shapes.release(context.user, now)

    def compute(self, context, now):
        if self.testers.distributor:
            shapes = self.shape_data(context.packet, context.tests.transforms > 0)
            context.results = self.testers.distribute(now, context.tests, context.slots, sum(span[1] for span in shapes))
            context.phase, context.at = COMPUTING, (min if self.forwards else max)(context.results)
            return self.clock.wake(context.at)
        context.phase, context.at = COMPUTING, self.testers.strip(now, context.tests, context.slots)
        self.clock.wake(context.at)

    def serve(self, now):
        """Rays in treelets go on, then packets whose data has come take units."""
        ready = []
        self.visits.run(now, ready)
        for context in ready:
            if self.resource.traversal.is_treelet(context.packet.node):
                self.walk(context, now)
            else:
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
            if context.phase == COMPUTING and self.testers.distributor and max(context.results) > now:
                self.end_part(context, now)
                continue
            self.trace.note(now, self.number, "tested", packet.number, len(packet.rays))
            if context.phase == COMPUTING or context.loaded:
                self.shapes.release(context.user, now)
            context.phase = FREE
            self.control.ask(context.asking, context.calls, now)
            self.hand_over(context.completed)
            if packet.owner == self.number and (self.own_last or not self.travels(packet)):
                entries = self.read_at_owner(packet)
                if entries > 0:
                    self.dispatch(now, entries)
                self.retire(packet, now, entries)
            else:
                self.way_out(packet).reserved -= 1
                self.depart(packet, now)
        return moved

    def end_part(self, context, now):
        """Behind a distributor that forwards stragglers: what is there goes on."""
        there = [at <= now for at in context.results]
        split = lambda values: ([v for v, t in zip(values, there) if t], [v for v, t in zip(values, there) if not t])
        packet, part = context.packet, copy.copy(context.packet)
        part.rays, packet.rays = split(packet.rays)
        part.masks, packet.masks = split(packet.masks)
        part.next, packet.next = split(packet.next)
        part.answered = min(packet.answered, len(part.rays))
        packet.answered -= part.answered
        part.blocks = 0
        _, context.results = split(context.results)
        _, context.rays = split(context.rays)
        done = [ray for ray in context.completed if ray in part.rays]
        context.completed = [ray for ray in context.completed if ray not in part.rays]
        context.at = min(context.results)
        self.clock.wake(context.at)
        self.hand_over(done)
        entries = self.read_at_owner(part)
        if entries > 0:
            self.dispatch(now, entries)
        self.retire_part(part, now, entries)

    def hand_over(self, completed):
        """Those that another visit still tests are kept back."""
        tested = {ray for context in self.contexts if context.phase != FREE for ray in context.rays}
        completed = self.late + completed
        self.done.extend(ray for ray in completed if ray not in tested)
        self.late = [ray for ray in completed if ray in tested]

    def shape_data(self, packet, transform):
        """What the tests of a packet need: its shapes, and what is stored of their instance's transform."""
        node = self.nodes[packet.node]
        shapes = tuple(node.treelet[:2]) if self.resource.treelets else tuple(node.block[:2]) if self.resource.by_block else node.shapes_of(packet.lane)
        return [shapes] + ([node.transform] if transform else [])
