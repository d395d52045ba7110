"""The shape data that a resource has at hand or on its way ("Shape buffer")."""
from collections import deque

from .clock import ceil_div

PLACE = 64


def places(span):
    return ceil_div(span[1], PLACE)


def places_to_ask(span):
    """A strip that ends by its flag may be as long as the longest one."""
    return ceil_div(max(span[1:]), PLACE)


class Entry:
    """A span in the buffer."""

    def __init__(self, span):
        self.span, self.places, self.holders, self.here = span, places_to_ask(span), 0, False
        self.waits = []  # users that wait for it


class User:
    """A test context, a ray, or a packet of the issue queue."""

    def __init__(self, owner):
        self.owner, self.entries, self.missing, self.need = owner, [], 0, []
        self.ahead = self.granted = False
        self.others = []  # that get what it fetches too

    def here(self):
        return self.granted and self.missing == 0


class ShapeBuffer:
    def __init__(self, config, port):
        self.port = port
        self.free = config["memory"]["shape_buffer_kib"] * 1024 // PLACE
        self.drops = config["memory"].get("shape_stay", "until_replaced") == "while_used"
        self.entries = {}    # by span
        self.idle = []       # entries that are here and nobody holds, the one given back longest ago first
        self.room = deque()  # users that wait for room
        self.queue = deque() # packets of the issue queue; the granted ones first
        self.ready = []      # users that waited and need wait no longer
        self.came_back = []  # whose spilled entries have been read

    def take(self, user, need, now):
        user.need = [span for span in need if span[1] > 0]
        if self.grant(user, True, now):
            return user.missing == 0
        self.room.append(user)
        return False

    def grant(self, user, test, now):
        def look():
            found = [self.entries[span] for span in user.need if span in self.entries]
            return found, sum(places_to_ask(span) for span in user.need if span not in self.entries)
        found, wanted = look()
        if wanted > 0:
            if self.room and not (test and self.room[0] is user):
                return False
            while self.free + sum(e.places for e in self.idle if e not in found) < wanted:
                granted = [ahead for ahead in self.queue if ahead.granted]
                if not test or not granted:
                    return False
                self.let_go(granted[-1])
                found, wanted = look()
        user.granted, user.missing, user.entries = True, 0, []
        for entry in found:
            self.hold(entry)
        for span in user.need:
            entry = self.entries.get(span)
            if entry is None:
                self.make_room(places_to_ask(span))
                entry = self.entries[span] = Entry(span)
                self.free -= entry.places
                self.hold(entry)
                self.port.request(span, entry, now, user.others, hint=True)
            if not entry.here:
                entry.waits.append(user)
                user.missing += 1
            user.entries.append(entry)
        return True

    def make_room(self, wanted):
        while self.free < wanted:
            oldest = self.idle.pop(0)
            del self.entries[oldest.span]
            self.free += oldest.places

    def hold(self, entry):
        entry.holders += 1
        if entry in self.idle:
            self.idle.remove(entry)

    def nobody_holds(self, entry):
        if self.drops:
            del self.entries[entry.span]
            self.free += entry.places
        else:
            self.idle.append(entry)

    def let_go(self, user):
        for entry in user.entries:
            if not entry.here:
                entry.waits.remove(user)
            entry.holders -= 1
            if entry.holders == 0 and entry.here:
                self.nobody_holds(entry)
        user.granted, user.entries, user.missing = False, [], 0

    def release(self, user, now):
        self.let_go(user)
        self.serve(now)

    def hand_over(self, giver, taker):
        taker.granted, taker.missing, taker.entries = True, 0, giver.entries
        giver.granted, giver.entries = False, []

    def take_ahead(self, user, need, now, others):
        user.others = others
        user.ahead, user.need = True, [span for span in need if span[1] > 0]
        self.queue.append(user)
        self.serve(now)

    def leave_queue(self):
        self.queue.popleft().ahead = False

    def serve(self, now):
        while self.room:
            user = self.room[0]
            if not self.grant(user, True, now):
                return
            self.room.popleft()
            if user.missing == 0:
                self.ready.append(user)
        for user in self.queue:
            if not user.granted and not self.grant(user, False, now):
                return

    def take_answers(self, now):
        given_up = False
        while self.port.answers.ready(now):
            entry = self.port.answers.take()
            if not isinstance(entry, Entry):  # a spilled block of a packet in the issue queue, or entries of a stack
                entry.spilled -= 1
                self.came_back.append(entry)
                continue
            entry.here = True
            if entry.places > places(entry.span):
                self.free += entry.places - places(entry.span)
                entry.places = places(entry.span)
                given_up = True
            for user in entry.waits:
                user.missing -= 1
                if user.missing == 0 and not user.ahead:
                    self.ready.append(user)
            entry.waits = []
            if entry.holders == 0:
                self.nobody_holds(entry)
                given_up = True
        while self.port.pushed.ready(now):
            self.take_pushed(self.port.pushed.take())
        if given_up:
            self.serve(now)

    def take_pushed(self, span):
        """For which another resource has asked."""
        if self.room or span in self.entries or self.free + sum(e.places for e in self.idle) < places(span):
            return
        self.make_room(places(span))
        entry = self.entries[span] = Entry(span)
        entry.places, entry.here = places(span), True
        self.free -= entry.places
        self.idle.append(entry)
