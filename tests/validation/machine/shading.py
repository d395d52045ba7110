"""Ray control and the shader workers ("Ray control", "Shading")."""
import heapq
from collections import deque

from .clock import ceil_div
from .shaders import ANY_HIT, Cores
from .travel import Sender
from .tree import Ray


class RayControl:
    """Gives new rays slots."""

    def __init__(self, config, tests):
        self.resources = config["topology"]["resources"]
        slots = config["rays"]["slots_per_resource"]
        self.balanced = config["rays"]["placement"] == "balanced"
        self.local = config["collections"]["home"] == "local" or config["topology"]["shape"] == "independent"
        self.group = config["packets"]["rays"]
        self.tests = tests
        self.free = [list(range(slots - 1, -1, -1)) for _ in range(self.resources)]
        self.enough = max(1, (slots if self.local else slots * self.resources) // 4)
        self.turn = 0
        self.waiting = deque()

    def next_resource(self):
        self.turn += 1
        return (self.turn - 1) % self.resources

    def emptiest(self):
        best = self.turn % self.resources
        for i in range(1, self.resources):
            r = (self.turn + i) % self.resources
            if len(self.free[r]) > len(self.free[best]):
                best = r
        return best

    def load(self, r, rays):
        """Gives slots of resource `r` to as many as there are; how many."""
        count = min(len(rays), len(self.free[r]))
        for ray in rays[:count]:
            ray.owner, ray.slot, ray.pending = r, self.free[r].pop(), self.tests
        return count

    def spread(self, rays):
        placed = 0
        if not self.balanced:
            refused = 0
            while placed < len(rays) and refused < self.resources:
                took = self.load(self.next_resource(), rays[placed:placed + 1])
                refused = 0 if took else refused + 1
                placed += took
            return placed
        for share_out in (True, False):
            for i in range(self.resources):
                if placed == len(rays):
                    break
                left = self.resources - i
                share = ceil_div(len(rays) - placed, left) if share_out else len(rays) - placed
                placed += self.load((self.turn + i) % self.resources, rays[placed:placed + share])
        return placed

    def place(self, rays):
        """Places groups from the front of `rays` (a deque); yields (issuer, group)."""
        turn = self.turn  # behind the last group that found room
        while rays:
            group = [rays[i] for i in range(min(self.group, len(rays)))]
            issuer = self.next_resource()
            if self.local and self.balanced:
                issuer = self.emptiest()
            room = len(self.free[issuer]) if self.local else sum(len(free) for free in self.free)
            if room < min(len(group), self.enough):
                if self.local and not self.balanced and len(self.free[self.emptiest()]) >= self.enough:
                    continue
                break
            placed = self.load(issuer, group) if self.local else self.spread(group)
            if placed == 0:
                break
            for _ in range(placed):
                rays.popleft()
            turn = self.turn
            yield issuer, group[:placed]
        self.turn = turn  # a group that waits costs nobody a turn

    def place_waiting(self):
        return list(self.place(self.waiting))

    def submit(self, rays):
        fresh = deque(rays)
        placed = [] if self.waiting else list(self.place(fresh))
        self.waiting.extend(fresh)
        return placed


class Sorter:
    """Completed rays on their way to the queues, with `sort: shader`."""

    def __init__(self, rate):
        self.rate, self.cycle, self.taken = rate, 0, 0
        self.rays = deque()  # (cycle in which it joins the queues, ray)

    def push(self, ray, now):
        if now > self.cycle:
            self.cycle, self.taken = now, 0
        if self.taken == self.rate:
            self.cycle, self.taken = self.cycle + 1, 0
        self.taken += 1
        self.rays.append((self.cycle + 1, ray))


class Queues:
    """Completed rays that wait for workers."""

    def __init__(self, config):
        s = config["shading"]
        self.lanes, self.sorted = s["lanes"], s["sort"] == "shader"
        self.how, self.seed = s["distribute"], config["image"]["seed"]
        self.queues = [deque() for _ in range(1 if self.how == "fifo_fill" else s["workers"])]
        self.in_work = [0] * s["workers"]
        self.turn = 0

    def push(self, ray):
        queue = 0
        if self.how == "round_robin":
            queue, self.turn = self.turn % len(self.queues), self.turn + 1
        elif self.how == "load":
            queue = min(range(len(self.queues)), key=lambda w: (len(self.queues[w]) + self.in_work[w], w))
        self.queues[queue].append(ray)

    def take(self, worker):
        """The rays of a vector."""
        queue = self.queues[0 if self.how == "fifo_fill" else worker]
        if not self.sorted:
            return [queue.popleft() for _ in range(min(self.lanes, len(queue)))]
        lists = {}
        for ray in queue:
            lists.setdefault(ray.fact["shader"], []).append(ray)
        lists = list(lists.values())  # in the order of their first rays
        full = [rays for rays in lists if len(rays) >= self.lanes]
        rays = ((full or lists or [[]])[0])[:self.lanes]
        for ray in rays:
            queue.remove(ray)
        return rays

    def empty(self):
        return not any(self.queues)


class Shading:
    def __init__(self, machine, controls):
        config = machine.config
        s, link = config["shading"], config["topology"]["link"]
        self.clock, self.trace, self.facts = machine.clock, machine.trace, machine.facts
        self.rays = {tuple(fact["name"]): fact for fact in self.facts["rays"]}
        self.camera = [tuple(name) for name in self.facts["camera"]]
        self.controls, self.node = controls, config["topology"]["resources"]
        self.control = RayControl(config, machine.initial_tests)
        self.shade = s["cycles_per_shade"]
        travel = config["rays"]["placement"] in ("first_taker", "addressed")
        self.data = machine.ray_data
        self.sender = Sender(config, ceil_div(64, link["bytes_per_cycle"]), controls) if travel else None
        self.lookup, self.products_per_cycle = s["cycles_per_lookup"], s["products_per_cycle"]
        self.any_hit, self.calls = s["cycles_per_any_hit"], deque()  # (resource, rays, calls)
        self.record = ceil_div(64, link["bytes_per_cycle"])
        self.slots = config["rays"]["slots_per_resource"] * self.node
        self.group = config["packets"]["rays"]
        self.queues = Queues(config)
        self.lanes = s["lanes"]
        self.sorter = Sorter(s["sort_rays_per_cycle"]) if s["sort"] == "shader" else None
        self.cores = Cores(machine) if s["program"]["default"] != "constant" else None
        self.held = self.cores.vectors if self.cores else 1  # places of a worker
        self.idle = list(range(s["workers"] * self.held - 1, -1, -1))  # the next one last
        self.in_work = [0] * len(self.idle)
        self.running = {}  # by place, what its programs work on
        self.jobs = []  # (end, worker, rays that it shades, names of the camera rays that it makes)
        self.gathered = []
        self.load_free = [0] * self.node
        self.made = self.making = self.outstanding = 0
        self.shaded = {}
        self.clock.wake(0)

    def step(self, now):
        for r, control in enumerate(self.controls):
            while control.completed.ready(now):
                rays = control.completed.take()
                if self.sender:
                    self.sender.completed(r, rays)
                else:
                    self.control.free[r].extend(ray.slot for ray in rays)
                for ray in self.data.completed(rays, now):
                    self.to_be_shaded(ray, now)
        stated, loaded, reads = self.data.take(now)
        for read in reads:
            self.cores.answer(read, now)
        for ray in stated:
            self.to_be_shaded(ray, now)
        while self.sorter and self.sorter.rays and self.sorter.rays[0][0] <= now:
            self.queues.push(self.sorter.rays.popleft()[1])
        for r, control in enumerate(self.controls):
            while control.questions.channel.ready(now):
                self.calls.append((r, *control.questions.channel.take()))
        for group in loaded:
            self.send(group.issuer, group.rays, now)
        while self.finish_jobs(now) or self.start_jobs(now):
            pass
        self.place(now)

    def to_be_shaded(self, ray, now):
        if self.sorter:
            self.sorter.push(ray, now)
            self.clock.wake(self.sorter.rays[-1][0])
        else:
            self.queues.push(ray)

    def emit(self, names, now):
        rays = [Ray(self.rays[tuple(name)]) for name in names]
        self.data.made(rays, now)
        self.gathered.extend(rays)
        self.outstanding += len(names)

    def finish_jobs(self, now):
        shaded, any_done = [], False
        for place in self.cores.step(now) if self.cores else ():
            heapq.heappush(self.jobs, (now, place, *self.running.pop(place)))
        while self.jobs and self.jobs[0][0] <= now:
            _, worker, rays, names = heapq.heappop(self.jobs)
            any_done = True
            self.idle.append(worker)
            self.set_in_work(worker, 0)
            if isinstance(rays, tuple):
                resource, asking = rays
                self.controls[resource].answers.send(8 * len(asking), now, asking)
                continue
            if rays:
                shaded += rays
                continue
            self.making -= len(names)
            self.emit(names, now)
        if not shaded:
            return any_done
        for ray in shaded:
            self.emit(ray.fact["children"], now)
            self.shaded[ray.name] = now
        self.data.shaded(shaded, now)
        self.trace.note(now, self.node, "shade", 0, len(shaded))
        self.outstanding -= len(shaded)
        return True

    def room(self):
        return max(0, min(self.group, self.slots - self.outstanding - self.making))

    def start_jobs(self, now):
        any_started = False
        if self.cores:
            self.idle = self.cores.order(self.idle)
        for worker in reversed(list(self.idle)):
            if self.start_job(worker, now):
                self.idle.remove(worker)
                any_started = True
        return any_started

    def cycles(self, rays):
        """The shaders of a vector run one after the other, each as long as the longest of its rays."""
        longest = {}
        for ray in rays:
            cycles = self.shade + self.lookup * ray.lookups
            if self.products_per_cycle > 0:
                cycles += ceil_div(ray.products, self.products_per_cycle)
            longest[ray.fact["shader"]] = max(longest.get(ray.fact["shader"], 0), cycles)
        return sum(longest.values())

    def set_in_work(self, place, rays):
        self.in_work[place] = rays
        first = place // self.held * self.held
        self.queues.in_work[place // self.held] = sum(self.in_work[first:first + self.held])

    def answer_calls(self, worker, now):
        """The any-hit calls that came first are a job."""
        resource, asking, calls = self.calls.popleft()
        self.set_in_work(worker, 1)
        if self.cores:
            self.running[worker] = (resource, asking), []
            return self.cores.begin(worker, [dict(call, shader=ANY_HIT) for call in calls], now)
        end = now + self.any_hit * ceil_div(len(calls), self.lanes)
        heapq.heappush(self.jobs, (end, worker, (resource, asking), []))
        self.clock.wake(end)

    def start_job(self, worker, now):
        if self.calls:
            self.answer_calls(worker, now)
            return True
        rays, names, end = self.queues.take(worker // self.held), [], now
        if rays:
            end += 0 if self.cores else self.cycles(rays)
        else:
            names = self.camera[self.made:self.made + self.room()]
            if not names:
                return False
            self.made += len(names)
            for name in names:
                self.data.paths.begin(name[0])
            self.making += len(names)
            end = now + self.shade * ceil_div(len(names), self.lanes)
        self.set_in_work(worker, len(names) or len(rays))
        if self.cores:
            self.running[worker] = rays, names
            self.cores.begin(worker, [ray.fact for ray in rays] or len(names), now)
            return True
        heapq.heappush(self.jobs, (end, worker, rays, names))
        self.clock.wake(end)
        return True

    def place(self, now):
        last = self.queues.empty() and not self.jobs and not self.running and not (self.sorter and self.sorter.rays)
        if self.sender:
            if len(self.gathered) >= self.group or (last and self.gathered):
                self.sender.submit(self.gathered)
                self.gathered = []
            return self.sender.send(now)
        groups = self.control.place_waiting()
        if len(self.gathered) >= self.group or (last and self.gathered):
            groups += self.control.submit(self.gathered)
            self.gathered = []
        for r in range(self.node):
            for issuer, rays in groups:
                if issuer != r:
                    continue
                self.trace.note(now, self.node, "place", 0, len(rays))
                if self.data.records:
                    self.data.fetch(r, rays, now)
                else:
                    self.send(r, rays, now)

    def send(self, issuer, rays, now):
        """Loads the records, and sends the IDs when all are loaded."""
        loaded = now
        for ray in rays:
            self.load_free[ray.owner] = max(self.load_free[ray.owner], now) + self.record
            loaded = max(loaded, self.load_free[ray.owner])
        self.controls[issuer].ids.send(4 * len(rays), loaded, rays)
