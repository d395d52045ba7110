"""Shape data: a resource's buffer, the shared caches, the memory behind them ("Memory")."""
import heapq

from .clock import Channel, SideWire, ceil_div, way_back, way_there
REQUEST = 16  # bytes
PAGE_TABLES = (1 << 53) - (1 << 48)


def piece_of(config):
    """The bytes that come from memory at a time: a sector, or a line."""
    m = config["memory"]
    sector = m.get("l2_sector_bytes", "auto")
    return m["line_bytes"] if sector in ("auto", None) else sector


class Line:
    def __init__(self, number):
        self.number, self.here, self.written = number, set(), set()  # pieces


class LineCache:
    """Lines of some pieces each; pieces come one by one."""

    def __init__(self, lines, ways, pieces):
        self.ways, self.pieces = ways, pieces
        self.sets = [[] for _ in range(lines // ways)]  # most recently used first

    def line(self, piece):
        """The line of a piece, if it has any, as the most recently used one."""
        number = piece // self.pieces
        entries = self.sets[number % len(self.sets)]
        for line in entries:
            if line.number == number:
                entries.remove(line)
                entries.insert(0, line)
                return line
        return None

    def touch(self, piece):
        line = self.line(piece)
        return line is not None and piece in line.here

    def insert(self, piece):
        """The written pieces that have to leave for it."""
        line, leave = self.line(piece), []
        if line is None:
            line = Line(piece // self.pieces)
            entries = self.sets[line.number % len(self.sets)]
            entries.insert(0, line)
            if len(entries) > self.ways:
                leave = sorted(entries.pop().written)
        line.here.add(piece)
        return leave

    def write(self, piece):
        self.line(piece).written.add(piece)


class ShapePort:
    """A resource's end of the wires to its cache."""

    def __init__(self, config, clock):
        m = config["memory"]
        self.wire = SideWire(clock, config, way_there(m["l1_latency_cycles" if m.get("l1_kib") else "l2_latency_cycles"]))
        self.requests, self.answers, self.pushed = self.wire.channel, Channel(clock), Channel(clock)
        self.line, self.hints = piece_of(config), []  # side wires to prefetchers

    def request(self, span, tag, now, others=(), hint=False):
        """Reads the lines of `span`; `tag` comes back, and `others` (clients of the cache) get the span too. Without a
        tag it writes them. A `hint` of it goes to the prefetcher."""
        (address, size), by_flag = span[:2], len(span) > 2
        first, last = address // self.line, (address + size - 1) // self.line
        length = (REQUEST - 2 if by_flag else REQUEST) + (size if tag is None else 0)
        self.wire.send(length + (8 if others else 0), now, (first, last - first + 1, tag, span, others))
        if hint and tag is not None:
            for wire in self.hints:
                wire.send(8, now, first)


class Request:
    def __init__(self, answers, tag, missing):
        self.answers, self.tag, self.ready, self.missing, self.pieces = answers, tag, 0, missing, missing
        self.span, self.others = None, ()
        self.walk = None


class Walk:
    """A strip that ends by its flag."""

    def __init__(self, first, lines, request):
        self.first, self.lines, self.request = first, lines, request
        self.looked_up, self.read, self.here = 0, 0, set()


class Bank:
    def __init__(self):
        self.looked_up = 0  # in lines: a cycle has lines_a_cycle of them
        self.fetched = 0    # pieces on their way
        self.stopped = []   # look-ups, of which the first cannot fetch


class Cache:
    """An L2 that some resources share. Each bank looks up so many lines a cycle."""

    def __init__(self, config, clock, ports, own=()):
        m = config["memory"]
        self.clock, self.ports, self.own = clock, ports, own  # resources, or their own caches
        self.piece = piece_of(config)
        pieces = m["line_bytes"] // self.piece
        sets, rays = m["l2_kib"] * 1024 // m["line_bytes"] // m["ways"], m.get("l2_ray_ways", 0)
        self.lines = LineCache(sets * (m["ways"] - rays), m["ways"] - rays, pieces)
        self.ray_lines = LineCache(sets * rays, rays, pieces) if rays else self.lines
        self.answer_bytes, self.answers_free = m.get("l2_answer_bytes_per_cycle", 0), 0
        self.back = way_back(m["l2_latency_cycles"])
        self.to_memory, self.from_memory = Channel(clock), Channel(clock)
        self.memory_latency = way_there(m["dram_latency_cycles"])
        self.lines_a_cycle = m["l2_lines_per_cycle"]
        self.banks = [Bank() for _ in range(m.get("l2_banks", 1))]
        self.mshrs = m.get("l2_mshrs", 0) or 1 << 60
        self.keeps_writes = m.get("l2_write", "through") == "back"
        self.waiting = {}   # piece: who waits for it (None: a writer), in the order in which they asked
        self.ahead = m.get("strip_ahead", 0)
        self.walks, self.turn = [], 0  # events: (cycle, turn, walk, a piece of it that is there)
        self.complete = []  # requests that wait for their answer to leave
        self.leaving = []   # requests to memory, each with the cycle in which it leaves
        self.prefetcher = None
        self.page = m.get("translation", {}).get("page_bytes", 0)
        self.levels = -(-(48 - self.page.bit_length() + 1) // 9)
        self.pages, self.entries = [], m.get("translation", {}).get("entries", 0)  # in the TLB, that used last at the end
        self.wanted, self.level = {}, 0  # pages that are not there, in order: what waits for them

    def step(self, now):
        while self.from_memory.ready(now):
            piece = self.from_memory.take()
            if piece * self.piece >= PAGE_TABLES:
                self.page_read(now)
            else:
                self.fill(piece, now)
        for cache in self.own:
            while cache.to_memory.ready(now):
                piece, write = cache.to_memory.take()
                if write:
                    self.look(piece, write if self.keeps_writes else "through", now)
                else:
                    self.look(piece, Request(cache.from_memory, piece, 1), now)
        for port in self.ports:
            while port.requests.ready(now):
                self.take(port.answers, port.requests.take(), now)
        while self.prefetcher and self.prefetcher.requests.ready(now):
            self.fetch_ahead(self.prefetcher.requests.take(), now)
        while self.walks and self.walks[0][0] <= now:
            _, _, walk, piece = heapq.heappop(self.walks)
            walk.here.add(piece - walk.first)
            self.walk(walk, now)
        for request in [request for request in self.complete if request.ready <= now]:
            self.complete.remove(request)
            arrival = now + self.back
            if self.answer_bytes:
                self.answers_free = max(self.answers_free, now) + ceil_div(request.pieces * self.piece, self.answer_bytes)
                arrival = self.answers_free - 1 + self.back
            request.answers.send(arrival, request.tag)
            for other in request.others:
                self.ports[other].pushed.send(arrival, request.span)
        for leaves in [leaves for leaves in self.leaving if leaves[0] <= now]:
            self.leaving.remove(leaves)
            self.to_memory.send(now + self.memory_latency, leaves[1])

    def take(self, answers, asked, now):
        first, lines, tag, span, others = asked
        (address, size), request = span[:2], Request(answers, tag, lines)
        request.span, request.others = span, others
        if len(span) > 2:
            request.walk = Walk(first, lines, request)
            return self.walk(request.walk, now)
        for piece in range(first, first + lines):
            begin = piece * self.piece
            whole = "whole" if address <= begin and begin + self.piece <= address + size else "part"
            how = request if tag is not None else whole if self.keeps_writes else "through"
            self.look(piece, how, now, whole)

    def walk(self, walk, now):
        """Reads the flags of the pieces that are there, in order, and looks up more while the end has not come."""
        read = walk.read
        while walk.read in walk.here:
            walk.read += 1
        if walk.read == walk.lines or (walk.looked_up and walk.read == read):
            return
        while walk.looked_up <= walk.read + self.ahead:
            past = walk.looked_up >= walk.lines
            self.look(walk.first + walk.looked_up, "past" if past else walk.request, now)
            walk.looked_up += 1

    def there(self, request, piece, at):
        if request.walk:
            self.turn += 1
            heapq.heappush(self.walks, (at, self.turn, request.walk, piece))
            self.clock.wake(at)

    def look(self, piece, how, now, whole="part"):
        bank = self.bank(piece)
        if (bank.stopped and how != "through") or not self.look_up(bank, piece, how, now, whole):
            bank.stopped.append((piece, how))

    def ways(self, piece):
        return self.ray_lines if piece * self.piece >= 1 << 40 else self.lines

    def bank(self, piece):
        return self.banks[piece // self.lines.pieces % len(self.banks)]

    def look_up(self, bank, piece, how, now, whole="part"):
        """False, and nothing is done, if the piece must be fetched and cannot be."""
        there, under_way = self.ways(piece).touch(piece), piece in self.waiting
        needs_it = how not in ("through", "whole")
        if how == "whole" and under_way:
            needs_it = True
        if needs_it and not there and not under_way and bank.fetched == self.mshrs:
            return False
        bank.looked_up = max(bank.looked_up, now * self.lines_a_cycle) + 1
        end = ceil_div(bank.looked_up, self.lines_a_cycle)
        if how == "through":
            self.leave(end, (piece, whole))
        elif there or not needs_it:
            if not there:
                self.insert(piece, end)
            if isinstance(how, Request):
                how.ready = max(how.ready, end)
                self.there(how, piece, end)
                self.one_less(how)
            elif how != "past":
                self.ways(piece).write(piece)
        else:
            if not under_way:
                self.waiting[piece] = []
                bank.fetched += 1
                self.leave(end, (piece, False))
            if isinstance(how, Request):
                how.ready = max(how.ready, end)
            self.waiting[piece].append(how if isinstance(how, Request) or how == "past" else None)
        return True

    def fetch_ahead(self, piece, now):
        bank = self.bank(piece)
        if bank.stopped:
            return
        bank.looked_up = max(bank.looked_up, now * self.lines_a_cycle) + 1
        if self.ways(piece).touch(piece) or piece in self.waiting or bank.fetched == self.mshrs:
            return
        self.waiting[piece] = ["past"]
        bank.fetched += 1
        self.leave(ceil_div(bank.looked_up, self.lines_a_cycle), (piece, False))

    def insert(self, piece, now):
        for written in self.ways(piece).insert(piece):
            self.leave(now, (written, "whole"))

    def leave(self, at, what):
        """What leaves for the memory needs its page."""
        if not self.page:
            return self.send(at, what)
        page = what[0] * self.piece // self.page
        if page in self.pages:
            self.pages.remove(page)
            self.pages.append(page)
            return self.send(at, what)
        self.wanted.setdefault(page, []).append((at, what))
        if len(self.wanted) == 1 and len(self.wanted[page]) == 1:
            self.read_level(at)

    def read_level(self, at):
        entry = next(iter(self.wanted)) >> 9 * (self.levels - 1 - self.level)
        self.send(at, ((PAGE_TABLES + (self.level << 44) + 8 * entry) // self.piece, False))

    def page_read(self, now):
        self.level += 1
        if self.level == self.levels:
            self.level = 0
            page = next(iter(self.wanted))
            for i, (at, what) in enumerate(self.wanted.pop(page)):
                self.send(max(at, now + i // (self.lines_a_cycle * len(self.banks))), what)
            del self.pages[:max(0, len(self.pages) + 1 - self.entries)]
            self.pages.append(page)
        if self.wanted:
            self.read_level(now)

    def send(self, at, what):
        self.leaving.append((at, what))
        self.clock.wake(at)

    def fill(self, piece, now):
        self.insert(piece, now)
        for request in self.waiting.pop(piece):
            if request is None:
                self.ways(piece).write(piece)
                continue
            if request == "past":
                continue
            request.ready = max(request.ready, now)
            self.there(request, piece, now)
            self.one_less(request)
        bank = self.bank(piece)
        bank.fetched -= 1
        while bank.stopped and self.look_up(bank, *bank.stopped[0], now):
            bank.stopped.pop(0)

    def one_less(self, request):
        request.missing -= 1
        if request.missing == 0:
            self.complete.append(request)
            self.clock.wake(request.ready)


def own_caches(config, clock, ports):
    """Those of the resources, if they have any."""
    m = config["memory"]
    own = []
    if m.get("l1_kib"):
        nearest = dict(m, l2_kib=m["l1_kib"], ways=m["l1_ways"], l2_lines_per_cycle=m["l1_lines_per_cycle"],
                       l2_mshrs=m["l1_mshrs"], l2_latency_cycles=m["l1_latency_cycles"], l2_banks=1, l2_write="through", l2_ray_ways=0, l2_answer_bytes_per_cycle=0,
                       dram_latency_cycles=m["l2_latency_cycles"], translation={})
        own = [Cache({"memory": nearest}, clock, [port]) for port in ports]
    return own


def caches_of(config, clock, ports, shading):
    """The caches, with the L2s behind the resources' own ones if they have any: L2s, all. `shading` has a port for each
    L2, or none."""
    own = own_caches(config, clock, ports)
    shared, l2 = config["memory"]["shared_by"], []
    for first in range(0, len(ports), shared):
        last = first + shared
        beside = shading[len(l2):len(l2) + 1]
        l2.append(Cache(config, clock, beside if own else ports[first:last] + beside, own[first:last]))
    return l2, own + l2


class Memory:
    """One channel of so many bytes a cycle."""

    def __init__(self, config, caches):
        m = config["memory"]
        self.caches = caches
        self.back = way_back(m["dram_latency_cycles"])
        self.line, self.width = piece_of(config), m["dram_bytes_per_cycle"]
        self.moved = 0  # in bytes: a cycle has `width` of them

    def step(self, now):
        for cache in self.caches:
            while cache.to_memory.ready(now):
                self.moved = max(self.moved, now * self.width) + self.line
                line, write = cache.to_memory.take()
                if not write:  # a line that is written gets no answer
                    cache.from_memory.send(ceil_div(self.moved, self.width) + self.back, line)
