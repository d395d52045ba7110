"""The choice among the first packets of an input queue ("A window")."""


class Window:
    """The part of a Tile that chooses."""

    def choose(self, d, now):
        """Brings the packet that dispatch takes next to the front of its queue."""
        port = self.in_ports[d]
        seen = port.window(now, 1 if self.passed_over[d] >= self.window else self.window)
        ready = [i for i, token in enumerate(seen) if self.window == 1 or self.can_handle(d, token)]
        if not ready:
            return False
        place = next((i for i in ready if self.window > 1 and not self.lacks_shapes(seen[i])), ready[0])
        if place == 0:
            self.passed_over[d] = 0
            return True
        self.passed_over[d] += 1
        port.bring_forward(place)
        self.dispatch_free = now + 1
        return True

    def is_tested_here(self, packet):
        return packet.records is None and not packet.memberships and self.number in packet.owners and (
            packet.owner != self.number or self.tests_own_last(packet))

    def can_handle(self, d, token):
        packet = token.packet
        if self.graph and token.stop != self.number:
            return False
        out = self.way_out(packet)
        if token.skip > 0:
            return self.topology.visit_all and out.has_place()
        if token.passes:
            return True
        if packet.records is not None:
            return packet.owner == self.number or out.has_place()
        context = self.free_context() is not None
        if token.answers:
            return context or packet.due > 1 or not self.tests_own_last(packet)
        if packet.owner == self.number:
            return context or not self.tests_own_last(packet)
        return out.has_place() and (context or not self.is_tested_here(packet))

    def lacks_shapes(self, token):
        packet = token.packet
        if (not self.fetch_by_resource or token.skip > 0 or token.passes or token.answers or
                not self.is_tested_here(packet) or self.is_treelet(packet)):
            return False
        entry = self.shapes.entries.get(self.shape_data(packet, False)[0])
        return entry is None or not entry.here
