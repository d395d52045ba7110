"""DRAM with banks, cycle by cycle ("DRAM with banks")."""
from .clock import ceil_div, way_back
from .memory import piece_of

NEVER = 1 << 62
UNIT = 32  # bytes of a transaction
PRESETS = {
    "gddr6_14": dict(period=570, pseudo=1, columns=64, cl=24, cwl=6, rcd=(30, 20), rp=30, ras=60, rc=90, rrd=(11, 11),
                     faw=43, rtp=4, wr=30, wtr=(9, 11), rtw=25, refi=3333, rfc=211, act=1, buses=1),
    "hbm2_2": dict(period=1000, pseudo=2, columns=32, cl=14, cwl=5, rcd=(14, 12), rp=14, ras=34, rc=48, rrd=(4, 4),
                   faw=15, rtp=5, wr=16, wtr=(6, 8), rtw=13, refi=3900, rfc=160, act=2, buses=2),
    "lpddr5_6400": dict(period=1250, pseudo=1, columns=64, cl=17, cwl=9, rcd=(15, 15), rp=15, ras=34, rc=49, rrd=(4, 4),
                        faw=16, rtp=8, wr=28, wtr=(5, 12), rtw=12, refi=3125, rfc=168, act=1, buses=1),
}
BL, CCD, GROUPS, BANKS = 2, (2, 4), 4, 4  # of all three
PPD, AAD, CLOCK_POST = 2, 8, 1  # of LPDDR5


class Request:
    def __init__(self, bank, row, write, transfer):
        self.bank, self.row, self.write, self.transfer = bank, row, write, transfer


class Bank:
    def __init__(self):
        self.row, self.activate, self.precharge, self.column, self.promised = None, 0, 0, [0, 0], 0


class Channel:
    def __init__(self, t, places):
        self.t, self.places = t, places
        self.arrivals, self.queues, self.active = ([], []), ([], []), []  # reads and writes
        self.banks = [Bank() for _ in range(t["pseudo"] * GROUPS * BANKS)]
        self.group_activate, self.group_column = [0] * (t["pseudo"] * GROUPS), [[0, 0] for _ in range(t["pseudo"] * GROUPS)]
        self.pseudo_activate, self.pseudo_column = [0] * t["pseudo"], [[0, 0] for _ in range(t["pseudo"])]
        self.activates = [[] for _ in range(t["pseudo"])]  # the last four
        self.bus = {"row": 0, "column": 0}
        self.writing, self.refresh, self.due = False, None, t["refi"]

    def busy(self):
        return any(self.arrivals) or any(self.queues) or self.active

    def take_bus(self, which, until):
        for bus in self.bus if self.t["buses"] == 1 else (which,):
            self.bus[bus] = until

    def may_move(self, request, now):
        group = request.bank // BANKS
        kind = int(request.write)
        return now >= max(self.banks[request.bank].column[kind], self.group_column[group][kind],
                          self.pseudo_column[group // GROUPS][kind], self.bus["column"])

    def may_change_row(self, request, now):
        bank, group = self.banks[request.bank], request.bank // BANKS
        if bank.row is not None:
            return bank.promised == 0 and now >= max(bank.precharge, self.bus["row"])
        last = self.activates[group // GROUPS]
        window = last[-4] + self.t["faw"] if len(last) >= 4 else 0
        return now >= max(bank.activate, self.group_activate[group], self.pseudo_activate[group // GROUPS], window,
                          self.bus["row"])

    def step(self, now):
        """The request that is served in this cycle, with the end of its data."""
        self.begin(now)
        return self.command(now)

    def begin(self, now):
        if now >= self.due and self.refresh is None:
            self.refresh = "close"
            self.due += self.t["refi"]
        for kind in (0, 1):
            if self.arrivals[kind] and self.arrivals[kind][0][0] <= now and len(self.queues[kind]) < self.places:
                self.queues[kind].append(self.arrivals[kind].pop(0)[1])
                break
        reads, writes = map(len, self.queues)
        if self.writing:
            self.writing = writes > (self.places // 4 if reads else 0)
        else:
            self.writing = writes >= self.places - self.places // 4 or (reads == 0 and writes > 0)

    def command(self, now):
        queue = self.queues[self.writing]
        served = row = None
        ready = [request for request in self.active if self.may_move(request, now)]
        if ready:
            served = ready[0]
            self.active.remove(served)
        if self.refresh is None:
            open_row = lambda request: self.banks[request.bank].row == request.row
            moves = [request for request in queue if open_row(request) and self.may_move(request, now)]
            changes = [request for request in queue if not open_row(request) and self.may_change_row(request, now)]
            if self.t["buses"] == 2:
                if served is None and moves:
                    served = moves[0]
                    queue.remove(served)
                row = next((c for c in changes if served is None or c.bank != served.bank), None)
            elif served is None:
                first = min(moves[:1] + changes[:1], key=queue.index, default=None)
                if first in moves:
                    served = first
                    queue.remove(first)
                else:
                    row = first
        if ready:  # its row is held in this cycle still
            self.banks[served.bank].promised -= 1
        if served is not None:
            done = self.move(served, now)
        if row is not None:
            self.change_row(row, queue, now)
        if self.refresh is not None and not self.active:
            self.do_refresh(now)
        return (served, done) if served is not None else None

    def move(self, request, now):
        t, bank, group = self.t, self.banks[request.bank], request.bank // BANKS
        kind, pseudo = int(request.write), request.bank // BANKS // GROUPS
        later = lambda times, i, at: times.__setitem__(i, max(times[i], at))
        later(self.pseudo_column[pseudo], kind, now + CCD[0])
        later(self.group_column[group], kind, now + CCD[1])
        done = now + (t["cwl"] if request.write else t["cl"]) + BL
        if request.write:
            bank.precharge = max(bank.precharge, done + t["wr"])
            later(self.pseudo_column[pseudo], 0, done + t["wtr"][0])
            later(self.group_column[group], 0, done + t["wtr"][1])
        else:
            bank.precharge = max(bank.precharge, now + t["rtp"])
            later(self.pseudo_column[pseudo], 1, now + t["rtw"])
        self.take_bus("column", now + 1)
        return done

    def change_row(self, request, queue, now):
        t, bank, group = self.t, self.banks[request.bank], request.bank // BANKS
        if bank.row is not None:
            bank.row, bank.activate = None, max(bank.activate, now + t["rp"])
            self.take_bus("row", now + 1)
            return
        bank.row, bank.precharge, bank.activate = request.row, now + t["ras"], now + t["rc"]
        bank.column = [now + t["rcd"][0], now + t["rcd"][1]]
        self.group_activate[group] = now + t["rrd"][1]
        self.pseudo_activate[group // GROUPS] = now + t["rrd"][0]
        self.activates[group // GROUPS].append(now)
        self.take_bus("row", now + t["act"])
        queue.remove(request)
        bank.promised += 1
        self.active.append(request)

    def all_closable(self, opened):
        return max([self.bus["row"]] + [bank.precharge for bank in opened])

    def do_refresh(self, now):
        if self.refresh == "close":
            opened = [bank for bank in self.banks if bank.row is not None]
            if opened:
                if now < self.all_closable(opened):
                    return
                for bank in opened:
                    bank.row, bank.activate = None, max(bank.activate, now + self.t["rp"])
                self.take_bus("row", now + 1)
            self.refresh = "refresh"
        if now < max([self.bus["row"]] + [bank.activate for bank in self.banks]):
            return
        for bank in self.banks:
            bank.activate = now + self.t["rfc"]
        self.take_bus("row", now + 1)
        self.refresh = None


class Lpddr5Channel(Channel):
    """An activate is two commands, and the data clock is started before data."""

    def __init__(self, t, places):
        super().__init__(t, places)
        self.precharge = 0                     # the earliest of any bank
        self.half, self.latest = None, 0       # the request whose row is half activated; the last cycle for the other half
        self.started, self.clock_stops = None, 0

    def busy(self):
        return super().busy() or self.half is not None or self.started is not None

    def may_change_row(self, request, now):
        if self.half is not None and (self.banks[request.bank].row is None or request.bank == self.half.bank):
            return False
        return super().may_change_row(request, now) and (self.banks[request.bank].row is None or now >= self.precharge)

    def all_closable(self, opened):
        return max(super().all_closable(opened), self.precharge)

    def candidate(self, now):
        """The request that goes first, and the list in which it stands."""
        for request in self.active:
            if self.may_move(request, now):
                return request, self.active
        queue = self.queues[self.writing]
        if self.refresh is None:
            for request in queue:
                hit = self.banks[request.bank].row == request.row
                if self.may_move(request, now) if hit else self.may_change_row(request, now):
                    return request, queue
        return None, queue

    def command(self, now):
        if self.started is not None:
            (request, place), self.started = self.started, None
            return self.serve(request, place, now)
        request, place = self.candidate(now)
        moves = request is not None and self.banks[request.bank].row == request.row
        stopped = moves and now >= self.clock_stops
        if self.half is not None and (request is None or now + stopped >= self.latest):
            self.open_half(now)
        elif stopped:
            self.started = request, place
            self.take_bus("column", now + 1)
        elif moves:
            return self.serve(request, place, now)
        elif request is not None:
            self.change(request, place, now)
        if self.refresh is not None and not self.active and self.half is None:
            self.close_and_refresh(now)
        return None

    def serve(self, request, place, now):
        place.remove(request)
        if place is self.active:
            self.banks[request.bank].promised -= 1
        done = self.move(request, now)
        self.clock_stops = max(self.clock_stops, done + CLOCK_POST)
        return request, done

    def change(self, request, place, now):
        if self.banks[request.bank].row is not None:
            self.precharge = now + PPD
            self.change_row(request, place, now)
            return
        self.change_row(request, place, now)
        self.active.remove(request)
        self.banks[request.bank].row = None
        self.half, self.latest = request, now + AAD

    def open_half(self, now):
        self.banks[self.half.bank].row = self.half.row
        self.active.append(self.half)
        self.half = None
        self.take_bus("row", now + 1)

    def close_and_refresh(self, now):
        before = [bank.row for bank in self.banks]
        self.do_refresh(now)
        if before != [bank.row for bank in self.banks]:
            self.precharge = now + PPD


def channel_of(preset, times, places):
    return (Lpddr5Channel if preset == "lpddr5_6400" else Channel)(times, places)


class BankedMemory:
    """DRAM with banks behind the caches, under its own clock."""

    def __init__(self, config, caches):
        m = config["memory"]
        d = m["dram"]
        t = dict(PRESETS[d["preset"]])
        if d["period_ps"] != "auto":
            t["period"] = d["period_ps"]
        if d["refresh_cycles"] != "auto":
            t["rfc"] = d["refresh_cycles"]
        if not d["refresh"]:
            t["refi"] = NEVER
        self.t, self.caches, self.line, self.d = t, caches, piece_of(config), d
        self.back = way_back(m["dram_latency_cycles"])
        self.channels = [channel_of(d["preset"], t, d["queue"]) for _ in range(d["channels"])]
        self.per_million = t["period"] * config["engine"]["clock_mhz"]  # engine cycles of a million DRAM cycles
        self.tick = 0

    def of_engine(self, cycle):
        return ceil_div(cycle * 1000000, self.per_million)

    def place(self, address):
        block, within = divmod(address // UNIT, self.d["interleave_bytes"] // UNIT)
        rest = block // len(self.channels) * (self.d["interleave_bytes"] // UNIT) + within
        sizes = {"column": self.t["columns"], "pseudo": self.t["pseudo"], "group": GROUPS, "bank": BANKS}
        part = {}
        for name in {"row_bank_column_group": ("pseudo", "group", "column", "bank"),
                     "row_bank_group_column": ("column", "pseudo", "group", "bank"),
                     "row_column_bank_group": ("pseudo", "group", "bank", "column")}[self.d["mapping"]]:
            rest, part[name] = divmod(rest, sizes[name])
        return block % len(self.channels), (part["pseudo"] * GROUPS + part["group"]) * BANKS + part["bank"], rest

    def run(self, end):
        while self.tick < end:
            for channel in self.channels:
                served = channel.step(self.tick)
                if served is None:
                    continue
                transfer = served[0].transfer
                transfer["missing"] -= 1
                if transfer["missing"] == 0 and transfer["line"] is not None:
                    transfer["cache"].from_memory.send(ceil_div(served[1] * self.per_million, 1000000) + self.back,
                                                       transfer["line"])
            self.tick += 1

    def step(self, now):
        self.run(self.of_engine(now))
        for cache in self.caches:
            while cache.to_memory.ready(now):
                line, write = cache.to_memory.take()
                transfer = {"missing": self.line // UNIT, "line": None if write else line, "cache": cache}
                for address in range(line * self.line, (line + 1) * self.line, UNIT):
                    channel, bank, row = self.place(address)
                    self.channels[channel].arrivals[bool(write)].append((self.tick, Request(bank, row, bool(write), transfer)))
        self.run(self.of_engine(now + 1))
        if any(channel.busy() for channel in self.channels):
            self.caches[0].clock.wake(now + 1)
