"""Shader workers that run programs ("Shader programs"): an interpreter that walks a program's text as a tree of blocks
with the set of lanes that take each, and the worker that issues what the interpreters of its vectors ask for."""
import heapq

import programs

KINDS = ["miss", "shadow", "unlit", "plain", "textured", "layered", "opaque", "layered_opaque", "transmissive",
         "layered_transmissive", "anything", "camera", "any_hit"]
FACTS = ["hit", "shadow", "bounce", "last", "lights", "emissive", "alpha", "lookups", "products"]
CAMERA, ANY_HIT = KINDS.index("camera"), KINDS.index("any_hit")
INSTRUCTION = 8


def class_of(name):
    if name in programs.BRANCHES:
        return "branch"
    return name if name in ("read", "texture", "trace") else programs.CLASS.get(name, "simple")


class Program:
    """The blocks of a text, its instructions numbered: items are (number, words, *blocks), of a loop (number, words,
    body, number of its end), of an if (number, words, then, otherwise or nothing, number of its else)."""

    def __init__(self, lines, parameters):
        self.lines = iter([line.replace(",", " ").split() for line in lines])
        self.parameters, self.size = parameters, 0
        self.registers = set(FACTS)
        self.body, _, _ = self.block()

    def number(self):
        self.size += 1
        return self.size - 1

    def block(self):
        """Its items, the word that ends it, and the number of that."""
        items = []
        for words in self.lines:
            name = words[0]
            if name == "else":
                return items, name, self.number()
            if name == "end":
                return items, name, None
            number = self.number()
            if name == "loop":
                items.append((number, words, self.block()[0], self.number()))
            elif name == "if":
                then, ended, jump = self.block()
                items.append((number, words, then, self.block()[0] if ended == "else" else None, jump))
            else:
                items.append((number, words))
                if name not in ("break", "stop", "trace"):
                    self.registers.add(words[1])
        return items, None, None


class Ask:
    """An instruction that a vector is to issue for some of its lanes."""

    def __init__(self, number, words, lanes):
        self.number, self.words, self.lanes = number, words, lanes
        self.kind = class_of(words[0])
        self.to = words[1] if self.kind in ("simple", "product", "divide", "read", "texture") else None
        operands = words[1:] if self.kind == "trace" else words[2:]
        if words[0] in ("if", "break", "stop"):
            operands = words[1:]
        if words[0] in ("loop", "load", "read", "else", "end"):
            operands = []
        self.registers = operands + ([self.to] if self.to else [])


def steps(program, lanes):
    """The instructions of lanes in step; `lanes` are dictionaries of registers."""
    def block(items, active):
        """The lanes that come to its end, and those that leave the loop around."""
        broke = set()
        for number, words, *blocks in items:
            if not active:
                break
            name = words[0]
            yield Ask(number, words, active)
            if name == "loop":
                body, end = blocks
                inside, left = active, set()
                for _ in range(int(words[1])):
                    inside, more = yield from block(body, inside)
                    left |= more
                    if not inside:
                        break
                    yield Ask(end, ["end"], inside)
                active = inside | left
            elif name == "if":
                then, otherwise, jump = blocks
                taken = {i for i in active if lanes[i][words[1]] != 0}
                rest, out = active - taken, set()
                if taken:
                    out, more = yield from block(then, taken)
                    broke |= more
                    if out and otherwise is not None:
                        yield Ask(jump, ["else"], out)
                if rest and otherwise is not None:
                    rest, more = yield from block(otherwise, rest)
                    broke |= more
                active = out | rest
            elif name in ("break", "stop"):
                leaving = {i for i in active if len(words) == 1 or lanes[i][words[1]] != 0}
                active = active - leaving
                broke |= leaving if name == "break" else set()
            elif name in ("read", "texture"):
                for i in active:
                    lanes[i][words[1]] = 0.0
            elif name == "load":
                for i in active:
                    lanes[i][words[1]] = programs.single(float(program.parameters.get(words[2], words[2])))
            elif name != "trace":
                for i in active:
                    lanes[i][words[1]] = programs.VALUES[name](*(lanes[i][word] for word in words[2:]))
        return active, broke

    yield from block(program.body, set(range(len(lanes))))


def by_line(reads, line):
    """The lines in which reads lie, each once."""
    lines = {at for offset, size in reads for at in range(offset // line, (offset + size - 1) // line + 1)}
    return [(at * line, line) for at in sorted(lines)]


class DataPath:
    """The TLB and the data cache of a worker, and its walker."""
    TABLES = ["material", "vertices", "texels"]

    def __init__(self, cores, cache, pages):
        self.clock, self.data = cores.clock, cores.data
        self.line = (cache["line_bytes"] if cache["bytes"] and cache["line_bytes"] != "auto" else None) or self.data.line
        self.latency = cache["latency_cycles"] if cache["bytes"] else 0
        self.sets = [[] for _ in range(cache["bytes"] // (self.line * cache["ways"]))]  # that used last at the end
        self.ways, self.entries, self.tlb = cache["ways"], pages["entries"], []
        bits = pages["page_bytes"].bit_length() - 1
        self.page, self.levels = pages["page_bytes"], -(-(48 - bits) // 9) if bits >= 0 else 0
        self.coming = {}  # by address: reads that wait for a line
        self.walks = []  # [page, reads that wait for it]
        self.level = self.free = 0
        self.events, self.order = [], 0

    def at(self, time, do, *what):
        self.order += 1
        heapq.heappush(self.events, (time, self.order, do, what))
        self.clock.wake(time)

    def due(self, now):
        return bool(self.events) and self.events[0][0] <= now

    def program_read(self, what, offset, size, by, now):
        self.at(self.take_port(now), self.look_up_page, ((self.TABLES.index(what) << 40) + offset, what, offset, by))

    def take_port(self, now):
        self.free = max(now, self.free) + 1
        return self.free - 1

    def step(self, now):
        while self.due(now):
            _, _, do, what = heapq.heappop(self.events)
            do(*what, now)

    def look_up_page(self, read, now):
        if not self.levels:
            return self.look_up_line(read, now)
        page = read[0] // self.page
        if page in self.tlb:
            self.tlb.remove(page)
            self.tlb.append(page)
            return self.look_up_line(read, now)
        for walk in self.walks:
            if walk[0] == page:
                return walk[1].append(read)
        self.walks.append([page, [read]])
        if len(self.walks) == 1:
            self.read_level(now)

    def read_level(self, now):
        entry = self.walks[0][0] // 512 ** (self.levels - 1 - self.level)
        self.data.program_read("pages", (self.level << 44) + 8 * entry, 8, (self, None), now)

    def look_up_line(self, read, now):
        address, what, offset, by = read
        if not self.sets:
            return self.data.program_read(what, offset, self.line, by, now)
        of = self.sets[address // self.line % len(self.sets)]
        if address in of:
            of.remove(address)
            of.append(address)
            self.at(now + self.latency, self.answer, by)
        elif address in self.coming:
            self.coming[address].append((by, now + self.latency))
        else:
            self.coming[address] = [(by, now)]
            self.at(now + self.latency, self.ask, read)

    def ask(self, read, now):
        self.data.program_read(read[1], read[2], self.line, (self, read[0]), now)

    def take(self, address, now):
        """A line has come, or an entry of the page table."""
        if address is not None:
            of = self.sets[address // self.line % len(self.sets)]
            del of[:max(0, len(of) + 1 - self.ways)]
            of.append(address)
            for by, known in self.coming.pop(address):
                self.at(max(now, known), self.answer, by)
            return
        self.level += 1
        if self.level < self.levels:
            return self.read_level(now)
        self.level = 0
        page, reads = self.walks.pop(0)
        del self.tlb[:max(0, len(self.tlb) + 1 - self.entries)]
        self.tlb.append(page)
        for read in reads:  # one a cycle, by the port of TLB and cache
            self.at(self.take_port(now), self.look_up_line, read)
        if self.walks:
            self.read_level(now)

    @staticmethod
    def answer(by, now):
        Cores.answer(by, now)


class Vector:
    """A place of a worker."""

    def __init__(self):
        self.runs = []  # that have not begun: (program, rays)
        self.next = self.asks = None
        self.free = self.there = 0
        self.ready, self.missing, self.filter = {}, {}, {}
        self.held = False

    def begin_run(self, now):
        self.program, self.rays = self.runs.pop(0)
        self.asks = steps(self.program[0], [dict(zip(FACTS, ray["facts"])) for ray in self.rays])
        self.next, self.free, self.ready = None, now, {}
        self.lookups = [0] * len(self.rays)


class Worker:
    def __init__(self, cores, vectors, path):
        self.cores, self.data = cores, path or cores.data
        self.vectors = [Vector() for _ in range(vectors)]
        self.free = 0
        self.lines = {}

    def fetch(self, address, now):
        cores = self.cores
        if cores.lines == 0:
            return now
        line = address // cores.line
        place = line % cores.lines
        if self.lines.get(place, (None, 0))[0] != line:
            self.lines[place] = line, now + cores.miss
        return max(now, self.lines[place][1])

    def step(self, now):
        """The places that have ended."""
        ended, able = [], []
        for index, v in enumerate(self.vectors):
            if not v.held:
                continue
            while v.next is None and v.free <= now:
                v.next = next(v.asks, None)
                if v.next is not None:
                    v.there = self.fetch(v.program[1] + INSTRUCTION * v.next.number, now)
                    self.cores.clock.wake(v.there)
                elif any(v.missing.values()):
                    break
                elif v.runs:
                    v.begin_run(now)
                else:
                    v.held = False
                    ended.append(index)
                    break
            if v.next is None or not v.held or any(v.missing.get(name, 0) for name in v.next.registers):
                continue
            at = max([v.there] + [v.ready.get(name, 0) for name in v.next.registers])
            if at <= now:
                able.append((at, index))
            else:
                self.cores.clock.wake(at)
        if able and self.free <= now:
            at, index = min(able)
            self.issue(self.vectors[index], now)
            self.free = now + 1
        if able:
            self.cores.clock.wake(max(now + 1, self.free))
        return ended

    def issue(self, v, now):
        ask, latency = v.next, self.cores.latency[v.next.kind]
        v.next, v.free = None, now + (latency if ask.kind in ("branch", "trace") else 1)
        self.cores.clock.wake(v.free)
        if not ask.to:
            return
        v.ready[ask.to] = now + max(1, latency)
        v.filter[ask.to] = latency
        if ask.kind not in ("read", "texture"):
            return
        reads = []
        for lane in ask.lanes:
            data = v.rays[lane]["reads"]
            if ask.kind == "read":
                reads += data[ask.words[2]]
            elif v.lookups[lane] < len(data["lookups"]):
                reads += data["lookups"][v.lookups[lane]]
                v.lookups[lane] += 1
        what = "texels" if ask.kind == "texture" else ask.words[2]
        reads = by_line(reads, self.data.line)
        v.missing[ask.to] = len(reads)
        for offset, size in reads:
            self.data.program_read(what, offset, size, (v, ask.to), now)


class Cores:
    def __init__(self, machine):
        config, s, p = machine.config, machine.config["shading"], machine.config["programs"]
        self.clock, self.data = machine.clock, machine.ray_data
        self.lanes, cache = s["lanes"], s["instruction_cache"]
        self.line, self.miss = cache["line_bytes"], cache["miss_cycles"]
        self.lines = cache["bytes"] // self.line
        self.latency = {kind: p[kind + "_cycles"] for kind in ("simple", "product", "divide", "branch", "texture", "trace")}
        self.latency["read"] = 0
        named, at, made = s["program"], 0, {}
        kinds = KINDS if config["testers"]["any_hit"] == "shader" else KINDS[:ANY_HIT]
        self.of_kind = []  # (program, address of its first instruction)
        for kind, word in enumerate(kinds):
            name = named.get(word, named["default"])
            key = (name, kind if name == "built_in" else None)
            if key not in made:
                text = machine.facts["built_in"][kind] if name == "built_in" else p["shaders"][name]["program"]
                parameters = {} if name == "built_in" else p["shaders"][name].get("parameters", {})
                made[key] = Program(text, parameters), at
                at += -(-made[key][0].size * INSTRUCTION // self.line) * self.line
            self.of_kind.append(made[key])
        most = max(len(program.registers) for program, _ in made.values())
        self.vectors = min(64, s["registers"] // (most * self.lanes))
        cached = s["data_cache"]["bytes"] or s["translation"]["page_bytes"]
        self.paths = [DataPath(self, s["data_cache"], s["translation"]) for _ in range(s["workers"] if cached else 0)]
        self.workers = [Worker(self, self.vectors, self.paths[w] if cached else None) for w in range(s["workers"])]

    def begin(self, place, rays, now):
        """`rays`: facts of completed rays, or a number of camera rays."""
        if isinstance(rays, int):
            rays = [{"shader": CAMERA, "facts": [0.0] * len(FACTS),
                     "reads": {"material": [], "vertices": [], "lookups": []}}] * rays
        v = self.workers[place // self.vectors].vectors[place % self.vectors]
        of = {}
        v.runs = []
        for ray in rays:
            program = self.of_kind[ray["shader"]]
            own = of.get(program[1])
            if own is None or len(own) == self.lanes:
                own = of[program[1]] = []
                v.runs.append((program, own))
            own.append(ray)
        v.held, v.missing = True, {}
        v.begin_run(now)

    @staticmethod
    def answer(read, now):
        v, register = read
        if isinstance(v, DataPath):
            return v.take(register, now)
        v.missing[register] -= 1
        if v.missing[register] == 0:
            v.ready[register] = now + v.filter[register]

    def step(self, now):
        ended = []
        while True:
            for w, worker in enumerate(self.workers):
                if self.paths:
                    self.paths[w].step(now)
                ended += [w * self.vectors + place for place in worker.step(now)]
            if not any(path.due(now) for path in self.paths):
                return ended

    def order(self, idle):
        """Idle places, the next one last."""
        taken = [sum(v.held for v in worker.vectors) for worker in self.workers]
        ranked = []
        for place in sorted(idle):
            ranked.append((taken[place // self.vectors], place))
            taken[place // self.vectors] += 1
        return [place for _, place in sorted(ranked, reverse=True)]
