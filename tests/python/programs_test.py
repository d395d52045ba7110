"""Programs of primitives through the front door: hits against a second interpreter (tests/validation/programs.py), the
primitives of configs/own_primitive.yaml against exact or sampled surfaces, one digest on all machines, and messages.
"""
import csv
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "validation"))
import programs  # noqa: E402

EXAMPLE = ROOT / "configs" / "own_primitive.yaml"
CLASSES = {kind: kind + "_instructions" for kind in ("simple", "product", "divide", "branch")}


def example(name):
    """The parameters and the program of a primitive of the example, read by its lines."""
    text = EXAMPLE.read_text().split(f"\n  {name}:\n")[1]
    parameters = dict(pair.split(": ") for pair in re.search(r"parameters: \{(.*)\}", text)[1].split(", "))
    lines = re.match(r"(?:      - .*\n)+", text.split("    program:\n")[1])[0].splitlines()
    return parameters, [line.split("#")[0].strip()[2:].strip() for line in lines]


def machine(lines, parameters, low, high, **more):
    """A primitive of that program in a place that nothing else reaches, and the rays of rays.csv."""
    return {
        "scene": {"builtin": "cornell", "objects": [{"primitive": "own"}]},
        "primitives": {"own": {"bounds": {"low": low, "high": high}, "parameters": parameters, "program": lines}},
        "workload": {"rays_from": "rays.csv"},
        "engine": {"kind": "native", "threads": 1},
        "topology": {"resources": 2},
        **more,
    }


class Folder:
    """A folder in which the program runs."""

    def __init__(self):
        self.held = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.held.name)

    def run(self, config, *options):
        if config is not None:
            (self.path / "own.json").write_text(json.dumps(config))
            options = ("own.json", *options)
        command = [os.environ["CAROUSEL"], "run", *options, "--quiet", "--no-html", "--force", "--out", "out"]
        return subprocess.run(command, cwd=self.path, capture_output=True, text=True)

    def trace(self, config, rays):
        """The report, and of each ray (t, u, v) or None."""
        rows = ["ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax"]
        rows += [f"{i},camera," + ",".join(repr(x) for x in ray) for i, ray in enumerate(rays)]
        (self.path / "rays.csv").write_text("\n".join(rows) + "\n")
        outcome = self.run(config, "--hits")
        if outcome.returncode != 0:
            raise AssertionError(outcome.stderr)
        hits = [None] * len(rays)
        lines = (self.path / "out/hits.csv").read_text().splitlines()
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            if row["t"] not in ("", "inf"):
                hits[int(row["ray"])] = tuple(programs.single(float(row[key])) for key in "tuv")
        return json.loads((self.path / "out/report.json").read_text()), hits


def octahedral(n):
    """Cigolle et al., JCGT 2014, section 3."""
    scale = sum(map(abs, n))
    x, y = n[0] / scale, n[1] / scale
    if n[2] < 0:
        x, y = math.copysign(1 - abs(y), x), math.copysign(1 - abs(x), y)
    return x / 2 + 0.5, y / 2 + 0.5


class RandomProgram:
    """Instructions at random, each of which reads what is set; then what they come to is brought between 1 and 9."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.lines, self.set = [], list(programs.INPUTS[:6])
        for i in range(4):
            self.lines.append(f"load c{i}, {self.random.choice(['-2.5', '0.75', '3', '1e-3', 'p'])}")
            self.set.append(f"c{i}")
        self.body(24, 0)
        self.lines += ["load one, 1", "load eight, 8", "load five, 5"]
        for number, register in enumerate(self.random.sample(self.set, 3)):
            self.lines += [f"abs x, {register}", "add y, one, x", "div x, x, y", "eq y, x, x", "select x, y, x, one",
                           "fma x, x, eight, one"]
            self.lines.append(f"hit x, dy, {self.random.choice(['one', 'dz', 'five'])}, dx")

    def body(self, count, depth):
        r = self.random
        for _ in range(count):
            what = r.random()
            if what < 0.08 and depth < 3:
                known = list(self.set)
                self.lines.append(f"loop {r.randint(1, 5)}")
                self.body(r.randint(1, 5), depth + 1)
                if r.random() < 0.6:
                    self.lines.append(f"break {r.choice(self.set)}")
                    self.body(r.randint(1, 3), depth + 1)
                self.lines.append("end")
                self.set = known
            elif what < 0.18 and depth < 3:
                known = list(self.set)
                self.lines.append(f"if {r.choice(self.set)}")
                self.body(r.randint(1, 4), depth + 1)
                if r.random() < 0.5:
                    self.set = list(known)
                    self.lines.append("else")
                    self.body(r.randint(1, 4), depth + 1)
                self.lines.append("end")
                self.set = known
            else:
                name = r.choice([n for n in programs.VALUES])
                operands = programs.VALUES[name].__code__.co_argcount
                to = f"r{r.randint(0, 9)}"
                self.lines.append(f"{name} {to}, " + ", ".join(r.choice(self.set) for _ in range(operands)))
                if to not in self.set:
                    self.set.append(to)


class SecondInterpreter(unittest.TestCase):
    def test_random_programs_hit_the_same_to_the_bit_in_the_same_time(self):
        folder, generator = Folder(), random.Random(7)
        for seed in range(6):
            program = RandomProgram(seed)
            rays = []
            for _ in range(60):
                spread = 10.0 ** generator.randint(-3, 1)
                direction = [programs.single(generator.uniform(-spread, spread)) for _ in range(3)]
                origin = [programs.single(generator.uniform(500, 520)) for _ in range(3)]
                rays.append(origin + direction + [0.0, math.inf])
            latency = {kind: generator.randint(1, 9) for kind in CLASSES}
            loads = any(re.match(r"load \w+, p$", line) for line in program.lines)
            config = machine(program.lines, {"p": 1.375} if loads else {}, [400] * 3, [640] * 3,
                             programs={kind + "_cycles": cycles for kind, cycles in latency.items()})
            report, hits = folder.trace(config, rays)
            runs = [programs.run(program.lines, {"p": "1.375"}, ray, latency) for ray in rays]
            for ray, run, hit in zip(rays, runs, hits):
                # Of equal distances the first that was reported counts.
                t, *normal = min((one for one in run.hits if any(one[1:])), key=lambda one: one[0])
                self.assertIsNotNone(hit, (seed, ray, run.hits))
                self.assertEqual(hit[0], t, (seed, ray))
                for told, expected in zip(hit[1:], octahedral([n for n in normal])):
                    self.assertAlmostEqual(told, expected, delta=2e-7)
            tests = report["tests"]
            self.assertEqual(tests["programs"]["count"], len(rays))
            self.assertEqual(tests["program_cycles"]["count"], sum(run.cycles for run in runs), seed)
            for kind, name in CLASSES.items():
                self.assertEqual(tests[name]["count"], sum(run.count[kind] for run in runs), (seed, kind))

    def test_the_example_s_programs_hit_the_same_to_the_bit(self):
        folder, generator = Folder(), random.Random(3)
        for name in "torus", "segment", "patch":
            parameters, lines = example(name)
            rays = rays_at(generator, 60, 0.9)
            # The object stands far below the room; heights are such that the way to its space and back is exact.
            below = []
            for ray in rays:
                ray[1] = round(ray[1] * 2**16) / 2**16
                below.append([ray[0], ray[1] - 64] + ray[2:])
            numbers = {key: float(value) for key, value in parameters.items()}
            config = machine(lines, numbers, [-1.5] * 3, [1.5] * 3)
            config["scene"]["objects"][0]["at"] = [0, -64, 0]
            _, hits = folder.trace(config, below)
            met = 0
            for ray, hit in zip(rays, hits):
                own = min((one[0] for one in programs.run(lines, parameters, ray).hits), default=None)
                self.assertEqual(hit[0] if hit else None, own, (name, ray))
                met += own is not None
            self.assertGreater(met, 8, name)


def rays_at(generator, count, reach):
    """Rays from around to points of the box [-reach, reach]^3 that begin outside of it."""
    rays = []
    for _ in range(count):
        angle, height = generator.uniform(0, 2 * math.pi), generator.uniform(-2, 2)
        origin = [3 * math.cos(angle), height, 3 * math.sin(angle)]
        to = [generator.uniform(-reach, reach) * 0.8 for _ in range(3)]
        rays.append([programs.single(x) for x in origin] + [programs.single(b - a) for a, b in zip(origin, to)] +
                    [0.0, math.inf])
    return rays


def along(ray, t):
    return [ray[i] + t * ray[3 + i] for i in range(3)]


def torus(p):
    return math.hypot(math.hypot(p[0], p[2]) - 0.7, p[1]) - 0.3


def segment(p):
    """The distance from the nearest sphere of the sweep, found by thirds: the distance has one minimum in s."""
    def distance(s):
        return math.dist(p, (0, s, 0)) - (0.3 - 0.2 * s)
    low, high = 0.0, 1.0
    for _ in range(32):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, b) if distance(a) < distance(b) else (a, high)
    return distance(low)


def wave(x):
    u = 2 * (1.5 * x - math.floor(1.5 * x)) - 1
    return (1 - u * u) ** 2


def patch(p):
    return p[1] - 0.12 * wave(p[0]) * wave(p[2])


class ExampleSurfaces(unittest.TestCase):
    """Each program against its surface in 64 bits, sampled finely along each ray and then halved."""

    def first_crossing(self, surface, ray, inside, steps):
        last = None
        for i in range(steps + 1):
            t = 0.5 + 1.0 * i / steps
            p = along(ray, t)
            value = surface(p) if inside(p) else None
            if value is not None and last is not None and value * last[1] <= 0:
                a, b = last[0], t
                for _ in range(50):
                    m = (a + b) / 2
                    a, b = (a, m) if surface(along(ray, m)) * last[1] <= 0 else (m, b)
                return a
            last = None if value is None else (t, value)
        return None

    def check(self, name, surface, inside, steps, most_unlike):
        generator = random.Random(11)
        parameters, lines = example(name)
        unlike = met = 0
        for ray in rays_at(generator, 120, 1.1):
            ray[:6] = [programs.single(x) for x in ray[:6]]
            hits = [one for one in programs.run(lines, parameters, ray).hits if inside(along(ray, one[0]))]
            told = min((one[0] for one in hits), default=None)
            exact = self.first_crossing(surface, ray, inside, steps)
            if told is not None:
                self.assertLess(abs(surface(along(ray, told))), 1e-4, (name, ray))
            if told is not None and exact is not None and abs(surface(along(ray, told))) < 1e-4 and \
                    abs(told - exact) < 2e-3:
                met += 1
            elif (told is None) != (exact is None) or told is not None:
                unlike += 1
        self.assertGreater(met, 15, name)
        self.assertLessEqual(unlike, most_unlike, name)

    def test_the_torus_is_one(self):
        self.check("torus", torus, lambda p: True, 700, 1)

    def test_the_segment_is_a_sweep_of_spheres(self):
        self.check("segment", segment, lambda p: math.dist(p, (0, 0.4, 0)) < 0.9, 150, 1)

    def test_the_patch_is_its_height(self):
        self.check("patch", patch, lambda p: abs(p[0]) <= 1 and abs(p[2]) <= 1 and -0.01 <= p[1] <= 0.13, 1500, 4)


SMALL = ["--set", "image={width: 24, height: 16, samples: 1, max_depth: 3}", "--set", "verify=reference", "--set",
         "rays.slots_per_resource=64", "--set", "packets.rays=8", "--set", "collections.ready=8"]


class Machines(unittest.TestCase):
    def report(self, folder, *sets):
        options = [part for one in sets for part in ("--set", one)]
        outcome = folder.run(None, str(EXAMPLE), *SMALL, *options)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return json.loads((folder.path / "out/report.json").read_text())

    def test_hits_and_picture_are_the_same_on_all_of_them(self):
        folder = Folder()
        base = self.report(folder)
        self.assertEqual(base["verify"]["mismatches"], 0)
        self.assertGreater(base["tests"]["programs"]["count"], 100)
        for sets in (["engine.kind=native", "engine.threads=2", "energy.profile=none"], ["engine.threads=2", "topology.shape=bidirectional"],
                     ["topology.shape=independent", "engine.simd=scalar"],
                     ["collections.traversal=ordered", "bvh.width=2", "cull_planes={count: 2, nodes: all}"],
                     ["bvh.storage=quantised", "collections.traversal=treelet", "programs.product_cycles=90"]):
            other = self.report(folder, *sets)
            self.assertEqual(other["digest"], base["digest"], sets)
            self.assertEqual(other["verify"]["mismatches"], 0, sets)

    def test_instructions_take_time_and_energy(self):
        folder = Folder()
        base = self.report(folder)
        slow = self.report(
            folder, "programs={simple_cycles: 40, product_cycles: 40, divide_cycles: 160, branch_cycles: 20}")
        counts = base["tests"]
        for name in CLASSES.values():  # which tests a closer hit spares depends on the order in which they come
            self.assertAlmostEqual(slow["tests"][name]["count"] / counts[name]["count"], 1, delta=0.05)
        self.assertGreater(slow["tests"]["program_cycles"]["count"], 5 * counts["program_cycles"]["count"])
        self.assertGreater(slow["engine"]["cycles"], 3 * base["engine"]["cycles"])
        joules = base["energy"]["parts"]["procedural_tests"]["joules"]
        spheres = counts["procedural"]["count"] - counts["programs"]["count"]
        self.assertEqual(spheres, 0)
        price = {"simple": 5.9, "product": 9.6, "divide": 23.4, "branch": 5.9}
        expected = 1e-12 * sum(price[kind] * counts[name]["count"] for kind, name in CLASSES.items())
        self.assertAlmostEqual(joules / expected, 1, places=4)


class Messages(unittest.TestCase):
    def refused_file(self, text):
        folder = Folder()
        (folder.path / "own.yaml").write_text(text)
        outcome = folder.run(None, "own.yaml")
        self.assertEqual(outcome.returncode, 2, outcome.stderr)
        self.assertFalse((folder.path / "out").exists())
        return outcome.stderr

    def refused(self, program, primitive="", objects="[{primitive: own}]", more=""):
        lines = "".join(f"      - {line}\n" for line in program)
        return self.refused_file(
            f"scene: {{builtin: cornell, objects: {objects}}}\nprimitives:\n  own:\n{primitive}    program:\n{lines}"
            f"{more}")

    def test_a_fault_of_a_program_stands_at_its_word(self):
        hit = "hit tmin, dx, dy, dz"
        for program, position, message in (
                (["mul a, ox, ox", "ad b, a, a", hit], "6:9", "found 'ad'; did you mean 'add'?"),
                (["mul a, ox, ox", "add b, a, aa", hit], "6:19", "expected a register that is set, found 'aa'"),
                (["if ox", "mov a, oy", "end", "add b, a, a", hit], "8:16", "the register a is not set on every way"),
                (["loop 3", "break ox", "mov a, oy", "end", "add b, a, a", hit], "9:16", "a is not set on every way"),
                (["loop", "end", hit], "5:9", "expected 1 operands of loop, found 0"),
                (["loop forever", "end", hit], "5:14", "a loop states its bound; expected an integer from 1 to 65536"),
                (["loop 300", "loop 300", "mov a, ox", "end", "end", hit], "9:9", "expected smaller bounds of loops"),
                (["loop 3", "mov a, ox", hit], "5:9", "expected an end of this loop"),
                (["mov a, ox", "end", hit], "6:9", "expected a loop or an if before this end"),
                (["mov a, ox", "break a", hit], "6:9", "expected a loop around this break"),
                (["mov ox, oy", hit], "5:13", "ox belongs to the ray and is only read"),
                (["load a, radius", hit], "5:17", "expected a number or the name of a parameter, found 'radius'"),
                (["load a, 1e-60", hit], "5:17", "expected a number that a float of 32 bits holds, found 1e-60"),
                (["add a, ox, 1", hit], "5:20", "expected the name of a register, found '1'"),
                (["mov a, ox"], "5:9", "expected a hit somewhere in the program"),
        ):
            text = self.refused(program)
            self.assertIn(f"own.yaml:{position}: ", text)
            self.assertIn(message, text)

    def test_faults_of_bounds_objects_and_machines_are_named(self):
        hit = ["hit tmin, dx, dy, dz"]
        self.assertIn("expected low below high along each axis",
                      self.refused(hit, "    bounds: {low: [0, 0, 0], high: [1, 0, 1]}\n"))
        self.assertIn("own.parameters.radius: the program loads no number of this name",
                      self.refused(hit, "    parameters: {radius: 2}\n"))
        self.assertIn("found 'ow'; did you mean 'own'?", self.refused(hit, objects="[{primitive: ow}]"))
        self.assertIn("expected the key 'primitive'", self.refused(hit, objects="[{scale: 2}]"))
        self.assertIn("did you mean 'offset'?", self.refused(hit, "    ofset: 1\n"))
        cycle = "engine: {kind: cycle}\n"
        self.assertIn("expected 1 unit, found 2", self.refused(hit, more=cycle + "testers: {procedural: 2}\n"))
        self.assertIn("lanes in step", self.refused(hit, more=cycle + "testers: {simd: {lanes: 4}}\n"))

    def shader_refused(self, program, shading="program: own", name="own"):
        lines = "".join(f"        - {line}\n" for line in program)
        return self.refused_file(
            f"scene: {{builtin: cornell}}\nengine: {{kind: cycle}}\nshading: {{{shading}}}\n"
            f"programs:\n  shaders:\n    {name}:\n      program:\n{lines}")

    def test_a_fault_of_a_shader_stands_at_its_word(self):
        for program, position, message in (
                (["load a, 1", "read b, materal"], "9:19", "expected one of material, vertices, found 'materal'"),
                (["hit hit, hit, hit, hit"], "8:11", "expected an instruction, found 'hit'"),
                (["add a, ox, hit"], "8:18", "expected a register that is set, found 'ox'"),
                (["mov lights, hit"], "8:15", "belongs to the ray and is only read"),
                (["trace b"], "8:17", "expected a register that is set, found 'b'"),
                (["loop", "end"], "8:11", "expected 1 operands of loop, found 0"),
                (["loop 65537", "end"], "8:16", "a loop states its bound"),
                (["loop 60000", "load a, 1", "end"], "10:11", "expected smaller bounds of loops"),
                (["texture a, a"], "8:22", "expected a register that is set, found 'a'")):
            text = self.shader_refused(program)
            self.assertIn(f"own.yaml:{position}: ", text)
            self.assertIn(message, text)
        self.assertIn("expected an instruction, found 'trace'", self.refused(["trace ox", "hit tmin, dx, dy, dz"]))

    def test_workers_hold_the_programs_that_are_named(self):
        plain = ["load a, 1"]
        self.assertIn("shading.program.default: expected a name of programs.shaders, or built_in, found 'owe'; did you "
                      "mean 'own'?", self.shader_refused(plain, "program: owe"))
        self.assertIn("shading.program.miss: expected a name", self.shader_refused(plain, "program: {default: own, miss: b}"))
        self.assertIn("expected shading.program.default beside it", self.shader_refused(plain, "program: {miss: own}"))
        self.assertIn("the largest program has 10 registers for each of 4 lanes; expected 40 at least, found 39",
                      self.shader_refused(plain, "program: own, lanes: 4, registers: 39"))
        self.assertIn("built_in is no name for a program of your own",
                      self.shader_refused(plain, "workers: 1", "built_in"))
        self.assertIn("expected a name of letters, digits and _, found 'a.b'",
                      self.shader_refused(plain, "program: built_in", "a.b"))
        self.assertIn("expected false with shading.program, found true",
                      self.shader_refused(plain, "program: own, idle_resources_shade: true"))
        self.assertIn("expected a multiple of line_bytes, which are 64, found 100",
                      self.shader_refused(plain, "program: own, instruction_cache: {bytes: 100}"))
        self.assertIn("expected a multiple of the 8 bytes of an instruction, found 60",
                      self.shader_refused(plain, "program: own, instruction_cache: {line_bytes: 60}"))


if __name__ == "__main__":
    unittest.main(warnings="ignore")
