"""Networks that are drawn ("A graph"): names and patterns, ways, places, and routers."""
import heapq
import math
import re

from .clock import Channel
from .network import InPort, OutPort, Topology


def names_of(nodes):
    """The numbers of nodes by name, and by group: kind by kind."""
    numbers, groups, drawn = {}, {}, []
    for kind in ("resource", "router", "cache", "memory", "shading"):
        for node in nodes:
            if node.get("kind", "resource") != kind:
                continue
            count = node.get("count", "auto")
            names = [node["name"]] if count == "auto" else [f"{node['name']}[{i}]" for i in range(count)]
            groups[node["name"]] = names
            for name in names:
                numbers[name] = len(drawn)
                drawn.append(node)
    return numbers, groups, drawn


class Drawing:
    """The nodes and one-way links of a configuration."""

    def __init__(self, topology):
        self.numbers, self.groups, self.nodes = names_of(topology["nodes"])
        self.resources = sum(node.get("kind", "resource") == "resource" for node in self.nodes)
        self.links = []  # (from, to, latency, width, depth, lane, carries); lane None: of all packets
        for link in topology["links"]:
            first, lanes = link.get("lane", "auto"), link.get("lanes", 1)
            own = first != "auto" or lanes > 1
            for i in range(lanes):
                self.add(link, topology["link"], (0 if first == "auto" else first) + i if own else None)
        self.lanes = max((link[5] + 1 for link in self.links if link[5] is not None), default=1)
        self.meet = self.lanes > 1 and any(link[5] is None for link in self.links)

    def find(self, pattern):
        found = []
        for part in pattern.split(","):
            name, inside = re.fullmatch(r"\s*(\w+)(?:\[(.*)\])?\s*", part).groups()
            group = self.groups[name]
            if inside is None or inside == "*":
                found += [self.numbers[one] for one in group]
            else:
                first, _, last = inside.partition("..")
                first, last = int(first), int(last or first)
                step = 1 if first <= last else -1
                found += [self.numbers[group[i]] for i in range(first, last + step, step)]
        return found

    def add(self, link, all_links, lane):
        if "ring" in link or "line" in link:
            nodes = self.find(link.get("ring", link.get("line")))
            pairs = list(zip(nodes, nodes[1:]))
            if "ring" in link and not (link.get("both") and len(nodes) == 2):
                pairs.append((nodes[-1], nodes[0]))
        elif "all_to" in link:
            pairs = [(a, b) for a in self.find(link["from"]) for b in self.find(link["all_to"]) if a != b]
        else:
            a, b = self.find(link["from"]), self.find(link["to"])
            pairs = list(zip(a * len(b) if len(a) == 1 else a, b * len(a) if len(b) == 1 else b))
        own = lambda key: all_links[key] if link.get(key, "auto") == "auto" else link[key]
        for pair in pairs:
            for a, b in [pair, pair[::-1]] if link.get("both") else [pair]:
                self.links.append((a, b, own("latency_cycles"), own("bytes_per_cycle"), own("depth"), lane,
                                   link.get("carries", ["packets"])))

    def ways(self, lane, kind="packets"):
        """By node and destination: the link by which the shortest way of a packet of the lane, or of another kind of
        messages, begins."""
        count = len(self.nodes)
        far = math.inf
        table = [[None] * count for _ in range(count)]
        for start in range(count):
            distance = [far] * count
            distance[start] = 0
            for _ in range(count):
                for a, b, latency, *_ in self.of(lane, kind):
                    distance[b] = min(distance[b], distance[a] + latency)
            # The last link of each way: from the node that is nearest to the start, and of the lowest number.
            last = [None] * count
            for i, (a, b, latency, *_) in enumerate(self.links):
                if self.links[i] not in self.of(lane, kind):
                    continue
                if b != start and distance[a] + latency == distance[b] < far:
                    if last[b] is None or (distance[a], a) < (distance[self.links[last[b]][0]], self.links[last[b]][0]):
                        last[b] = i
            for end in range(count):
                at = end
                while last[at] is not None and self.links[last[at]][0] != start:
                    at = self.links[last[at]][0]
                table[start][end] = last[at]
        return table

    def of(self, lane, kind="packets"):
        return [link for link in self.links if link[5] in (None, lane) and kind in link[6]]


def rings_of_rings(topology):
    """The shape hierarchical as a drawing ("Rings of rings")."""
    resources, groups = topology["resources"], min(topology["groups"], topology["resources"])
    links = []
    for group in range(groups):
        members = [f"r[{r}]" for r in range(resources) if r * groups // resources == group]
        links.append({"ring": ", ".join([f"bridge[{group}]", *members])})
        if groups > 1:
            links.append({"from": f"bridge[{group}]", "to": f"bridge[{(group + 1) % groups}]"})
    return {**topology, "shape": "graph", "tour": "names", "links": links,
            "nodes": [{"name": "r", "count": resources},
                      {"name": "bridge", "kind": "router", "count": groups, "forward": "whole"}]}


class GraphTopology(Topology):
    def __init__(self, config):
        t = config["topology"]
        self.drawing = Drawing(t)
        self.resources, self.shape = self.drawing.resources, "graph"
        self.visit_all, self.bus, self.directions = t["visit"] == "all", False, self.drawing.lanes
        self.tables = [self.drawing.ways(lane) for lane in range(self.directions)]
        depth = t["link"]["depth"]
        self.in_flight = depth if t["flow"] == "credits" else min(depth * self.resources, 256)
        self.rounds = [self.tour(t.get("tour", "names"), lane) for lane in range(self.directions)]
        links = self.drawing.links
        self.widths = sorted({link[3] for link in links})
        by = lambda node, end, other: sorted((i for i, link in enumerate(links) if link[end] == node),
                                             key=lambda i: (links[i][5] or 0, links[i][other]))
        self.ins = [by(node, 1, 0) for node in range(len(self.drawing.nodes))]
        self.outs = [by(node, 0, 1) for node in range(len(self.drawing.nodes))]
        self.room = self.needs_room(t)
        self.bubble_holds = t["flow"] == "bubble" and not self.room

    def node_cycles(self, node):
        return self.drawing.nodes[node].get("latency_cycles", 0)

    def way(self, start, end, lane):
        at = start
        while at != end:
            link = self.tables[lane][at][end]
            yield link
            at = self.drawing.links[link][1]

    def tour(self, rule, lane):
        """By resource: the one after it."""
        order = list(range(self.resources))
        if rule == "nearest":
            left, order = set(range(1, self.resources)), [0]
            while left:
                cost = lambda to: sum(self.drawing.links[i][2] + self.node_cycles(self.drawing.links[i][0])
                                      for i in self.way(order[-1], to, lane))
                order.append(min(left, key=lambda to: (cost(to), to)))
                left.remove(order[-1])
        return {a: b for a, b in zip(order, order[1:] + order[:1])}

    def next(self, here, direction):
        return self.rounds[direction][here]

    def stop(self, packet, here):
        """Where the packet goes from here."""
        at = self.next(here, packet.direction)
        while not self.visit_all and at != packet.owner and not self.wanted(packet, at):
            at = self.next(at, packet.direction)
        return at

    def skip(self, packet, here):
        return super().skip(packet, here) if self.visit_all else 0

    def port(self, packet, here):
        return self.port_to(self.stop(packet, here), here, packet.direction)

    def port_to(self, stop, here, lane):
        return self.outs[here].index(self.tables[lane][here][stop])

    def prepare(self, token, here):
        """For the next link to its stop: the time that it takes, and whether the next node passes it on at once."""
        links, table = self.drawing.links, self.tables[token.packet.direction]
        link = table[here][token.stop]
        token.cycles, at = token.sizes[links[link][3]], links[link][1]
        if at == token.stop or self.drawing.nodes[at].get("forward", "head") == "whole":
            return False
        return links[table[at][token.stop]][3] == links[link][3]

    def needs_room(self, t):
        """Whether resources have places for all packets, as credits or a bubble do not keep circles from filling up."""
        links, places = self.drawing.links, [link[4] + 1 for link in self.drawing.links]
        after = [set() for _ in links]
        come, leave = [set() for _ in range(self.resources)], [set() for _ in range(self.resources)]
        for lane in range(self.directions):
            for a in range(self.resources):
                for b in range(self.resources):
                    if a == b or (self.visit_all and self.next(a, lane) != b):
                        continue
                    way = list(self.way(a, b, lane))
                    for i, j in zip(way, way[1:]):
                        after[i].add(j)
                    leave[a].add((way[0], lane))
                    come[b].add((way[-1], lane))
        for i, link in enumerate(links):
            at = link[1]
            if at < self.resources:
                after[i] |= {j for j, lane in leave[at] if (i, lane) in come[at]}
            elif self.drawing.nodes[at].get("buffers", "auto") == "auto":
                after[i] = set()
        least = math.inf
        for start in range(len(links)):
            best, heap = {}, [(0, 0, start)]
            while heap:
                held, length, i = heapq.heappop(heap)
                if i == start and length:
                    least = min(least, held)
                    break
                if best.get(i, math.inf) < held:
                    continue
                for j in after[i]:
                    if held + places[j] < best.get(j, math.inf):
                        best[j] = held + places[j]
                        heapq.heappush(heap, (held + places[j], length + 1, j))
        if least == math.inf:
            return False
        if t["flow"] == "credits":
            return self.in_flight * self.resources * (self.directions if self.drawing.meet else 1) >= least
        rings = (not self.drawing.meet and len(self.drawing.nodes) == self.resources and
                 all(len(self.drawing.of(lane)) == self.resources for lane in range(self.directions)))
        return not (t["flow"] == "bubble" and rings and all(link[4] >= 2 for link in links))


class Router:
    """A node that passes packets on."""

    def __init__(self, number, topology, ports):
        self.number, self.topology, (self.in_ports, self.out_ports) = number, topology, ports
        self.turn, self.last = 0, 0

    def due(self):
        """When something comes that may move a packet."""
        times = [port.packets.items[0][0] for port in self.in_ports if port.packets.items]
        for out in self.out_ports:
            if out.queue and out.credits == 0:
                times += [at for at, _ in list(out.credit_channel.items)[:1]]
            elif out.queue:
                times.append(max(out.free_at, out.queue[0][1]))
        return min((at for at in times if at > self.last), default=math.inf)

    def step(self, now):
        if self.due() > now:
            return
        self.last = now
        for out in self.out_ports:
            out.take_credits(now)
        waits, room = self.take_in(now), True
        while room:
            room = any([out.send(now) for out in self.out_ports]) and waits
            if room:
                waits = self.take_in(now)
        if waits:
            self.turn = (self.turn + 1) % len(self.in_ports)

    def take_in(self, now):
        waits = False
        for i in range(len(self.in_ports)):
            port = self.in_ports[(self.turn + i) % len(self.in_ports)]
            while port.ready(now):
                token = port.front()
                out = self.out_ports[self.topology.port_to(token.stop, self.number, token.packet.direction)]
                if not out.has_place():
                    waits = True
                    break
                through = self.topology.prepare(token, self.number)
                port.take(now)
                out.push(token, now, through)
        return waits


def connect_graph(clock, topology, places):
    """The ports of each resource, and the routers behind them."""
    drawing = topology.drawing
    ends = [([None] * len(topology.ins[n]), [None] * len(topology.outs[n])) for n in range(len(drawing.nodes))]
    for i, (a, b, latency, _, depth, *_) in enumerate(drawing.links):
        packets, credits = Channel(clock), Channel(clock)
        room = drawing.nodes[a].get("buffers", "auto") if a >= topology.resources else places
        if room == "auto" or (a < topology.resources and topology.room):
            room = math.inf
        ends[a][1][topology.outs[a].index(i)] = OutPort(clock, packets, credits, latency + topology.node_cycles(a),
                                                        depth, room)
        back = latency + drawing.nodes[b].get("credit_cycles", 0)
        ends[b][0][topology.ins[b].index(i)] = InPort(packets, credits, back)
    return [*ends[:topology.resources],
            *(Router(n, topology, ends[n]) for n in range(topology.resources, len(drawing.nodes)))]
