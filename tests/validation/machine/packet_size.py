"""What a packet is on a link, and what dispatch reads of it ("Links", "Results")."""
from .clock import ceil_div


class PacketSize:
    def __init__(self, config, nodes, width=None):
        self.nodes = nodes
        self.ordered = config["collections"]["traversal"] == "ordered"
        self.treelets = config["bvh"].get("treelets", {}).get("bytes", 0) > 0
        self.entry = 4 if config["collections"]["policy"] == "nearest" else 0
        self.data = config["packets"]["carry"] == "data"
        self.results = config["packets"]["results"]
        self.ids_per_cycle = config["packets"]["ids_per_cycle"]
        self.width = width or config["topology"]["link"]["bytes_per_cycle"]

    # ---- on a link

    def cycles(self, packet, treelet):
        n, node = len(packet.rays), self.nodes[packet.node] if packet.records is None else None
        if packet.records is not None:
            return self.link(16 + 4 * n + sum(64 if address is None else 66 for _, address in packet.records))
        if packet.memberships:
            return self.link(16 + 4 * n)
        data = node.shapes_of(packet.lane)[1] if self.data and not treelet else 0
        transform = node.transform[1] if self.data and not treelet else 0
        parts = self.parts(packet, treelet)
        if parts:
            return parts * self.link(self.of_shape(n) + ceil_div(data, parts) + transform)
        cycles = self.link(self.whole(packet, n, treelet) + data + transform)
        return cycles + self.messages(packet, range(n), treelet) * self.link(self.message())

    def answer_cycles(self, packet, members, treelet):
        """On a bus, the answer for the packet's rays at the places `members`. It brings no shapes."""
        n = len(members)
        if self.results == "message":
            return self.link(16) + self.messages(packet, members, treelet) * self.link(self.message())
        if self.results == "implied_order":
            return self.link(self.in_order(packet, 0, n, treelet))
        if self.results == "per_shape":
            boxes = self.boxes(packet, treelet)
            return boxes * self.link(self.of_shape(n)) if boxes else self.link(16 + 4 * n)
        return self.link(self.whole(packet, n, treelet))

    # ---- dispatch

    def on_visit(self, packet, treelet):
        n = len(packet.rays)
        if packet.memberships or packet.records is not None:
            return n
        if self.results == "implied_order":
            return n - packet.answered
        return self.in_parts(n, self.parts(packet, treelet))

    def at_owner(self, packet, treelet, bus):
        n = len(packet.rays)
        if packet.memberships:
            return n
        if self.results == "message" and not bus:
            return n + self.ids_per_cycle * self.messages(packet, range(n), treelet)
        return self.in_parts(n, self.parts(packet, treelet))

    def of_answer(self, packet, members, treelet):
        if self.results == "message":
            return self.ids_per_cycle * self.messages(packet, members, treelet)
        return self.in_parts(len(members), self.boxes(packet, treelet) if self.results == "per_shape" else 0)

    # ---- parts

    def link(self, size):
        return ceil_div(size, self.width)

    def inner(self, packet, treelet):
        return self.nodes[packet.node].inner and not treelet

    def boxes(self, packet, treelet):
        if not self.inner(packet, treelet):
            return 0
        return max(1, self.nodes[packet.node].shapes) if packet.lane is None else 1

    def parts(self, packet, treelet):
        """Packets that it has become, one a shape; 0 while it is one for all of them."""
        return self.boxes(packet, treelet) if self.results == "per_shape" and packet.answered else 0

    def in_parts(self, n, parts):
        return parts * max(1, ceil_div(n, self.ids_per_cycle)) * self.ids_per_cycle if parts else n

    def of_shape(self, n):
        return 16 + 4 * n + ceil_div(n, 8) + self.entry

    def message(self):
        return 20 + (12 if self.ordered else self.entry)

    def messages(self, packet, members, treelet):
        """Hits of rays that the packet's owner does not have."""
        if self.results != "message" or not (self.ordered or self.inner(packet, treelet)):
            return 0
        others = [i for i in members if packet.rays[i].owner != packet.owner]
        if self.ordered:
            return sum(packet.next[i] is not None for i in others)
        return sum(len(packet.masks[i]) for i in others)

    def whole(self, packet, n, treelet):
        if self.results == "implied_order":
            return self.in_order(packet, n - packet.answered, packet.answered, treelet)
        size = 16 + 4 * n
        if self.results != "mask":
            return size
        size += 10 * len(packet.groups)
        if self.ordered:
            return size + 12 * n
        if self.treelets:
            return size + (9 + self.entry) * len(packet.exits)
        return size + self.box_results(packet, n, treelet)

    def in_order(self, packet, ids, results, treelet):
        size = 18 + ceil_div(ids + results, 8) + 4 * ids
        if self.ordered:
            return size + 12 * results
        return size + self.box_results(packet, results, treelet)

    def box_results(self, packet, results, treelet):
        if not self.inner(packet, treelet):
            return 0
        return results + 8 * self.entry if packet.lane is None else ceil_div(results, 8) + self.entry
