"""Data of rays and paths in memory ("Master copies", "Data in memory")."""
from .clock import ceil_div
from .memory import ShapePort
from .shaders import by_line

RECORDS, STATES, FILM = 1 << 50, 1 << 51, 1 << 52
SKY = FILM + (1 << 51)
TABLES = {"material": SKY + (1 << 48), "vertices": SKY + (1 << 49), "texels": SKY + (1 << 50),
          "pages": SKY + (3 << 49)}
RECORD, PIXEL = 64, 16


class Records:
    """A group of new rays whose records are on their way."""

    def __init__(self, issuer, rays):
        self.issuer, self.rays, self.missing = issuer, rays, len(rays)


class Lines:
    """What a shader worker reads."""

    def __init__(self, by, missing):
        self.by, self.missing = by, missing


class Shading:
    """A completed ray whose path state, parts of the sky, or surface are on their way."""

    def __init__(self, ray, missing):
        self.ray, self.missing = ray, missing


class PathStates:
    """Which state a path has: one that was given back last, or else a new one."""

    def __init__(self):
        self.free, self.number = [], 0
        self.of_path, self.rays = {}, {}  # by path: its state, and its rays that have not been shaded

    def begin(self, path):
        if not self.free:
            self.free, self.number = [self.number], self.number + 1
        self.of_path[path] = self.free.pop()

    def made(self, path):
        self.rays[path] = self.rays.get(path, 0) + 1

    def shaded(self, paths):
        """A batch of rays; the paths that end with them."""
        ended = []
        for path in paths:
            self.rays[path] -= 1
            if self.rays[path] == 0:
                ended.append(path)
        self.free.extend(self.of_path[path] for path in ended)
        return ended


class RayData:
    def __init__(self, config, facts, clock):
        m = config["memory"]
        self.records = m.get("ray_records") == "master"
        self.state_bytes = facts["state_bytes"] if m.get("path_state") == "memory" else 0
        sky = m.get("sky_map") == "memory"
        self.sky = {tuple(fact["name"]): fact.get("sky", []) for fact in facts["rays"] if sky}  # reads by ray
        self.film, self.pixels = m.get("film") == "memory", facts["pixels"]
        self.shared, self.line = m["shared_by"], m["line_bytes"]
        self.slots = config["rays"]["slots_per_resource"]
        self.paths = PathStates()
        caches = ceil_div(config["topology"]["resources"], self.shared)
        own = dict(config, memory=dict(m, l1_kib=0))
        programs = config["shading"]["program"]["default"] != "constant"
        self.surfaces = m.get("surfaces") == "memory" and not programs
        used = programs or self.surfaces or self.records or self.film or sky or m.get("path_state") == "memory"
        self.ports = [ShapePort(own, clock) for _ in range(caches if used else 0)]

    def record_of(self, ray):
        return RECORDS + (ray.owner * self.slots + ray.slot) * RECORD, RECORD

    def state_of(self, ray):
        room = ceil_div(self.state_bytes, self.line) * self.line
        return STATES + self.paths.of_path[ray.name[0]] * room, self.state_bytes

    def port(self, span):
        return self.ports[span[0] // self.line % len(self.ports)]

    def fetch(self, issuer, rays, now):
        records = Records(issuer, rays)
        for ray in rays:
            span, port = self.record_of(ray), self.ports[ray.owner // self.shared]
            port.request(span, None, now)
            port.request(span, records, now)

    def completed(self, rays, now):
        """Those that are to be shaded now."""
        for ray in rays if self.records else ():
            self.ports[ray.owner // self.shared].request(self.record_of(ray), None, now)
        ready = []
        for ray in rays:
            spans = [self.state_of(ray)] if self.state_bytes else []
            spans += [(SKY + offset, size) for offset, size in self.sky.get(ray.name, [])]
            if self.surfaces:
                spans += self.surface_of(ray)
            waiting = Shading(ray, len(spans))
            for span in spans:
                self.port(span).request(span, waiting, now)
            if not spans:
                ready.append(ray)
        return ready

    def surface_of(self, ray):
        reads = ray.fact["reads"]
        tables = [("material", reads["material"]), ("vertices", reads["vertices"])]
        tables += [("texels", texels) for texels in reads["lookups"]]
        return [(TABLES[what] + offset, size) for what, data in tables for offset, size in by_line(data, self.line)]

    def made(self, rays, now):
        for ray in rays:
            self.paths.made(ray.name[0])
            if self.state_bytes:
                span = self.state_of(ray)
                self.port(span).request(span, None, now)

    def shaded(self, rays, now):
        for path in self.paths.shaded([ray.name[0] for ray in rays]):
            if self.film:
                span = FILM + PIXEL * self.pixels[path], PIXEL
                self.port(span).request(span, span, now)

    def program_read(self, what, offset, size, by, now):
        """A walker reads an entry, and others lines."""
        lines = [(offset, size)] if what == "pages" else by_line([(offset, size)], self.line)
        waiting = Lines(by, len(lines))
        for offset, size in lines:
            span = TABLES[what] + offset, size
            self.port(span).request(span, waiting, now)

    def take(self, now):
        """Rays whose states have come, groups whose records have, and what programs read."""
        rays, groups, reads = [], [], []
        for port in self.ports:
            while port.answers.ready(now):
                what = port.answers.take()
                if isinstance(what, tuple):
                    port.request(what, None, now)
                    continue
                what.missing -= 1
                if isinstance(what, Lines):
                    reads += [what.by] if what.missing == 0 else []
                    continue
                if what.missing == 0 and isinstance(what, Records):
                    groups.append(what)
                elif what.missing == 0:
                    rays.append(what.ray)
        return rays, groups, reads
