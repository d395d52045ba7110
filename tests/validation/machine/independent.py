"""A resource of the conventional machine: every ray in a slot is a thread ("Independent resources")."""
import heapq

from .shape_buffer import ShapeBuffer, User
from .testers import Testers
from .traversal import Transforms
from .walk import Walk


class Thread:
    def __init__(self, ray, nodes, transforms, order):
        self.ray, self.walk, self.node, self.user = ray, Walk(ray, 0, nodes, transforms, order), None, User(self)
        self.beyond = self.spilled = 0  # entries of its stack in memory; reads of them


class IndependentTile:
    def __init__(self, number, machine, shapes, control):
        self.number, self.clock, self.trace, self.nodes = number, machine.clock, machine.trace, machine.nodes
        self.control = control
        self.shapes = ShapeBuffer(machine.config, shapes)
        self.testers = Testers(machine.config, number)
        self.transforms = Transforms(machine.config)
        self.tests, self.turn = [], 0
        self.done = []
        self.order = machine.config["collections"]["order"]
        self.registers = machine.config["testers"].get("stack_entries", 0) or 1 << 60

    def step(self, now):
        while self.control.new_rays.ready(now):
            rays = self.control.new_rays.take()
            self.trace.note(now, self.number, "new_rays", 0, len(rays))
            for ray in rays:
                self.advance(Thread(ray, self.nodes, self.transforms, self.order), now)
        while self.control.answers.channel.ready(now):
            for thread in self.control.answers.channel.take():
                self.advance(thread, now)
        self.shapes.take_answers(now)
        while self.shapes.came_back:
            thread = self.shapes.came_back.pop(0)
            thread.beyond = self.first_of_refill(thread)
            self.advance(thread, now)
        self.serve(now)
        while self.tests and self.tests[0][0] <= now:
            thread = heapq.heappop(self.tests)[2]
            self.trace.note(now, self.number, "tested_ray", thread.ray.slot, 1)
            self.shapes.release(thread.user, now)
            self.spill(thread, now)
            if thread.ray.asked:
                self.control.ask([thread], thread.ray.take_calls(), now)
            else:
                self.advance(thread, now)
            self.serve(now)
        if self.done:
            self.trace.note(now, self.number, "complete", 0, len(self.done))
            self.control.complete(self.done, now)
            self.done = []

    def serve(self, now):
        ready, self.shapes.ready = self.shapes.ready, []
        for user in ready:
            self.test(user.owner, now)

    def advance(self, thread, now):
        thread.node = thread.walk.next(thread.beyond)
        thread.beyond = min(thread.beyond, len(thread.walk.waiting()))
        if thread.node is None and thread.beyond:
            thread.spilled += 1
            return self.shapes.port.request(self.entries(thread, self.first_of_refill(thread), thread.beyond), thread, now)
        if thread.node is None:
            self.done.append(thread.ray)
            return
        node = self.nodes[thread.node]
        need = [node.strip] + ([node.transform] if thread.walk.enters(thread.node) else [])
        if self.shapes.take(thread.user, need, now):
            self.test(thread, now)

    def first_of_refill(self, thread):
        return max(0, thread.beyond - (self.registers + 1) // 2)

    def entries(self, thread, first, last):
        """Where some entries of a stack are in memory."""
        nodes = thread.walk.waiting()
        at = (self.number + 1 << 40) + (thread.ray.slot << 14) + thread.walk.bytes(nodes[:first])
        return at, thread.walk.bytes(nodes[first:last])

    def spill(self, thread, now):
        last = len(thread.walk.waiting()) - self.registers
        if last > thread.beyond:
            self.shapes.port.request(self.entries(thread, thread.beyond, last), None, now)
            thread.beyond = last

    def test(self, thread, now):
        counts = thread.walk.test(thread.node)
        end = self.testers.ray(self.testers.read(now, 1), counts, counts.inversions)
        self.turn += 1
        heapq.heappush(self.tests, (end, self.turn, thread))
        self.clock.wake(end)
