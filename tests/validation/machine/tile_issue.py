"""Packets of a resource's own: from a collection to the issue queue, and to dispatch ("Fill the issue queue")."""
from .resource import PACKET
from .shape_buffer import User
from .tile_tests import COMPUTING, FREE


class Issue:
    """A packet of the resource's own that waits for its shapes and for dispatch."""

    def __init__(self, packet):
        self.packet, self.user = packet, None
        self.spilled = 0  # spilled blocks that have not come back

    def ready(self):
        return self.spilled == 0 and (self.user is None or self.user.here())


class Issues:
    """The part of a Tile that sends packets out."""

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

    def partial_may_go(self, now):
        """Whether a collection that is not ready may go."""
        if self.partial == "idle":
            return (not self.issue and self.dispatch_free <= now and all(c.phase == FREE for c in self.contexts) and
                    not any(port.ready(now) for port in self.in_ports))
        if self.partial == "after":
            return False
        free = sum(context.phase == FREE for context in self.contexts)
        if self.starts_later and not self.stays and len(self.issue) >= free:
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
            tested = self.number in packet.owners and not self.tests_own_last(packet)
            if not packet.memberships and (brings or tested):
                issue.user = User(issue)
                self.shapes.take_ahead(issue.user, self.shape_data(packet, True), now, self.others_of(packet))
            self.read_spilled(issue, now)
            self.issue.append(issue)
        return moved

    def others_of(self, packet):
        """The other resources behind the same cache that want the packet, by their numbers there."""
        first = self.number // self.shared_by * self.shared_by
        return [r - first for r in range(first, first + self.shared_by)
                if self.multicast and r != self.number and r in packet.owners]

    def handle_issue(self, now):
        if not self.issue or not self.issue[0].ready():
            return False
        packet, user = self.issue[0].packet, self.issue[0].user
        travels = self.travels(packet)
        if travels:
            out = self.way_out(packet)
            if not out.has_place() or (self.bubble and out.spare_places() < 2):
                return False
        tested = not packet.memberships and self.number in packet.owners and not self.tests_own_last(packet)
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
                self.way_out(packet).reserved += 1
            if user is not None:
                self.shapes.hand_over(user, context.user)
            self.begin_test(context, packet, self.dispatch_free, user is not None)
        else:
            if user is not None:
                self.shapes.release(user, now)
            self.depart(packet, self.dispatch_free)
        return True

