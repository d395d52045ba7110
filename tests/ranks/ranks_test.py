"""The native engine over ranks of MPI: hits and picture are those of one process, whatever the ranks and threads; what
ranks cannot do is refused by name; a rank that dies or hangs ends the run, without files.

CAROUSEL names the program. Where it has no module mpi, the suite checks that it says so, and skips the rest."""

import array
import functools
import json
import math
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

CAROUSEL = os.environ["CAROUSEL"]
EFFORT = float(os.environ.get("CAROUSEL_EFFORT", "1"))  # below 1 a part of the cases (tests/support/random_runs.h)
MACHINE = """
scene: {builtin: terrain, triangles: 2000}
image: {width: 40, height: 32, samples: 2, max_depth: 4}
engine: {kind: native, threads: 2}
topology: {resources: 5, shape: ring}
rays: {slots_per_resource: 256}
"""
LONG = ["image.width=1600", "image.height=1200", "image.samples=64"]
# As root in a container, on fewer cores than ranks, and over shared memory or TCP.
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_mpi_yield_when_idle="1",
                   OMPI_MCA_hwloc_base_binding_policy="none", ASAN_OPTIONS="detect_leaks=0")


@functools.cache
def starts_processes():
    """Whether MPI can run on this host at all, which is not the program's doing."""
    try:
        return subprocess.run(["mpirun", "-n", "2", "true"], capture_output=True, timeout=60, env=ENVIRONMENT).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


# Tests that wait long, or need a large scene: script/soak runs them.
long_test = unittest.skipUnless(EFFORT >= 1, "takes long: CAROUSEL_EFFORT=1, as in script/soak, runs it")


def some(cases):
    return cases[::max(1, round(1 / EFFORT))]


def sets(assignments):
    return [word for assignment in assignments for word in ("--set", assignment)]


class Ranks(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.config = self.folder / "machine.yaml"
        self.config.write_text(MACHINE)
        refusal = self.alone(["engine.transport=mpi"])
        self.assertEqual(refusal.returncode, 2)
        self.assertIn("engine.transport", refusal.stderr)
        if "the module mpi is not there" in refusal.stderr:
            self.skipTest("the program has no module mpi")
        if not starts_processes():
            self.skipTest("mpirun cannot start two processes of any program here")

    def command(self, out, assignments):
        return [CAROUSEL, "run", str(self.config), "--quiet", "--out", str(self.folder / out), *sets(assignments)]

    def alone(self, assignments, out="alone"):
        return subprocess.run(self.command(out, assignments) + ["--force"], capture_output=True, text=True, timeout=120)

    def over(self, ranks, assignments=(), out="ranks", options=()):
        command = ["mpirun", *options, "-n", str(ranks), *self.command(out, ["engine.transport=mpi", *assignments]),
                   "--force"]
        return subprocess.run(command, capture_output=True, text=True, timeout=120, env=ENVIRONMENT)

    def report(self, out):
        return json.loads((self.folder / out / "report.json").read_text())

    def digests(self, out):
        return self.report(out)["digest"]

    def same(self, assignments, ranks, **more):
        with self.subTest(assignments=assignments, ranks=ranks):
            self.assertEqual(self.alone(assignments).returncode, 0)
            run = self.over(ranks, assignments, **more)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(self.digests("ranks"), self.digests("alone"))
            self.assertEqual(self.report("ranks")["rays"], self.report("alone")["rays"])
            self.counted(ranks)
            shutil.rmtree(self.folder / "ranks")

    def counted(self, ranks):
        """What one rank sends as its part of the machine's work, the report counts."""
        report = self.report("ranks")
        if ranks == 1:
            return self.assertNotIn("ranks", report)
        self.assertEqual(sum(rank["resources"] for rank in report["ranks"]), len(report["resources"]))
        self.assertEqual(sum(rank["rays_shaded"] for rank in report["ranks"]), report["rays"]["completed"])
        owner = [rank["rank"] for rank in report["ranks"] for _ in range(rank["resources"])]
        between = sum(link["packets"] for link in report["links"] if owner[link["from"]] != owner[link["to"]])
        self.assertEqual(sum(link["packets"] for link in report["rank_links"]), between)
        for way in report["rank_links"]:
            links = [link for link in report["links"] if (owner[link["from"]], owner[link["to"]]) == (way["from"], way["to"])]
            self.assertEqual(way["full"], sum(link["full_stalls"] for link in links))
            self.assertAlmostEqual(way["packets_per_message"], way["packets"] / way["messages"])
            self.assertAlmostEqual(way["held"], way["hold_ns"] * 1e-9 / report["host"]["wall_seconds"])
        sent, returned = (sum(link[key] for link in report["rank_links"]) for key in ("rays", "results"))
        self.assertEqual(sent, returned)


class SameHits(Ranks):
    def test_any_number_of_ranks_and_threads(self):
        for ranks, threads in some([(1, 2), (2, 1), (2, 2), (3, 3), (5, 2), (4, 1)]):
            self.same([f"engine.threads={threads}"], ranks)

    def test_any_shape_and_flow(self):
        for assignments, ranks in some([(["topology.shape=bidirectional", "topology.resources=6"], 3),
                                        (["topology.visit=owners"], 2),
                                        (["topology.shape=point_to_point", "topology.visit=owners"], 3),
                                        (["topology.link.depth=1"], 3),
                                        (["topology.flow=bubble", "topology.link.depth=2"], 4)]):
            self.same(assignments, ranks)

    def test_any_traversal_home_and_placement(self):
        for assignments, ranks in some([(["collections.traversal=ordered"], 2), (["collections.home=local"], 2),
                                        (["collections.traversal=treelet"], 3), (["rays.placement=round_robin"], 2),
                                        (["collections.home=hash", "collections.when_full=spill"], 3),
                                        (["packets.shapes=single"], 2),
                                        (["rays.slots_per_resource=4", "packets.rays=4"], 4)]):
            self.same(assignments, ranks)

    def test_any_scene(self):
        self.same(["scene.builtin=instances"], 3)
        self.same(["primary=raster"], 2)
        self.same(["image.width=1", "image.height=1", "image.samples=1"], 3)  # fewer paths than ranks

    def test_over_tcp(self):
        self.same([], 3, options=("--mca", "btl", "self,tcp"))


PARTITIONED = ["scene.placement=partitioned", "collections={home: hash, when_full: spill}"]


def write_patches(path, side, cells):
    """A landscape of side * side meshes, each of cells * cells * 2 triangles."""
    data, views, accessors = bytearray(), [], []

    def add(words, kind, component, count, **more):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(words) * words.itemsize})
        data.extend(words.tobytes())
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind, **more})
        return len(accessors) - 1

    corners = ((z * (cells + 1) + x) for z in range(cells) for x in range(cells))
    row = cells + 1
    indices = array.array("I", (v for a in corners for v in (a, a + row, a + 1, a + 1, a + row, a + row + 1)))
    meshes = []
    for mesh in range(side * side):
        points = array.array("f")
        for z in range(row):
            for x in range(row):
                u, v = x / cells + mesh % side, z / cells + mesh // side
                height = 0.15 * math.sin(5 * u) * math.cos(4 * v) + 0.02 * math.sin(31 * u + 17 * v)
                points.extend((x / cells, height, z / cells))
        position = add(points, "VEC3", 5126, row * row, min=[0, -1, 0], max=[1, 1, 1])
        meshes.append({"primitives": [{"attributes": {"POSITION": position},
                                       "indices": add(indices, "SCALAR", 5125, len(indices)), "material": mesh % 2}]})
    nodes = [{"mesh": mesh, "translation": [mesh % side, 0, mesh // side]} for mesh in range(side * side)]
    path.with_suffix(".bin").write_bytes(data)
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.6, 0.4, 1]}},
            {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.6, 0.9, 0.4]}, "alphaMode": "BLEND"}], "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "meshes": meshes, "accessors": accessors, "bufferViews": views,
        "buffers": [{"uri": path.with_suffix(".bin").name, "byteLength": len(data)}]}))


class PartitionedScene(Ranks):
    def partitioned(self, assignments, ranks):
        """The whole scene in one process, and its shares at several ranks, give the same."""
        whole = ["collections={home: hash, when_full: spill}", *assignments]
        with self.subTest(assignments=assignments, ranks=ranks):
            self.assertEqual(self.alone(whole).returncode, 0)
            run = self.over(ranks, [*whole, "scene.placement=partitioned"])
            self.assertEqual(run.returncode, 0, run.stderr)
            one, several = self.report("alone"), self.report("ranks")
            self.assertEqual(several["digest"], one["digest"])
            self.assertEqual(several["rays"]["completed"], one["rays"]["completed"])
            self.assertEqual(several["structure"]["primitives"], one["structure"]["primitives"])
            self.assertAlmostEqual(several["structure"]["surface_cost"] / one["structure"]["surface_cost"], 1, delta=0.4)
            self.counted(ranks)
            if ranks > 1:
                self.assertGreater(sum(link["shape_bytes"] for link in several["rank_links"]), 0)
                for rank in several["ranks"]:
                    self.assertLess(rank["structure_bytes"], one["host"]["accel_bytes"])
            shutil.rmtree(self.folder / "ranks")

    def test_any_number_of_ranks_and_traversal(self):
        scene = ["scene.builtin=instances", "scene.instances=60"]
        for ranks, more in some([(4, ["engine.threads=1"]), (1, []), (2, ["collections.traversal=treelet"]),
                                 (3, ["packets.shapes=single"]), (3, ["collections.traversal=ordered"]),
                                 (3, ["topology.shape=point_to_point", "topology.visit=owners"]),
                                 (2, ["topology.shape=bidirectional", "collections.traversal=treelet",
                                      "bvh.treelet_triangles=100"])]):
            self.partitioned(scene + more, ranks)
        self.partitioned([], 3)  # a scene of one mesh
        write_patches(self.folder / "patches.gltf", 3, 8)
        self.partitioned(["scene={file: patches.gltf}"], 3)  # every second mesh lets light through

    def test_what_it_does_not_do(self):
        for assignment in ("engine.transport=local", "collections.home=issuer", "cull_planes.count=4", "bvh.storage=quantised", "bvh.elements=spheres", "bvh.levels=3",
                           "bvh.top_triangles=4", "bvh.file=trees"):
            refusal = self.alone(["engine.transport=mpi", *PARTITIONED, assignment])
            self.assertEqual(refusal.returncode, 2)
            self.assertIn("scene.placement: replicated", refusal.stderr)
        refusal = self.alone(["engine.transport=mpi", *PARTITIONED, "packets.shapes=single",
                              "collections.traversal=treelet"])
        self.assertIn("packets.shapes: above treelets", refusal.stderr)

    @long_test
    def test_a_scene_that_no_rank_could_hold(self):
        """The limit lies between what a rank needs of four and what each needs for the whole: a million triangles, of
        which a process holds 110 MB, and more while it builds the structure."""
        write_patches(self.folder / "patches.gltf", 6, 120)
        scene = ["scene={file: patches.gltf}", "engine.threads=1", "image.samples=1"]
        taken = re.search("has ([0-9]+) MiB before", self.over(4, scene + ["engine.memory_limit_mib=1"]).stderr)
        self.assertTrue(taken)
        if int(taken[1]) > 1000:
            self.skipTest("this program's memory is watched by a sanitizer")
        self.assertEqual(self.alone(scene).returncode, 0)
        scene.append(f"engine.memory_limit_mib={int(taken[1]) + 110}")
        refused = self.over(4, scene)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertRegex(refused.stderr, "rank [0-3]: error: .*memory")
        self.assertFalse((self.folder / "ranks").exists())
        run = self.over(4, scene + PARTITIONED)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.digests("ranks"), self.digests("alone"))


class Refusals(Ranks):
    def refused(self, run, *texts):
        self.assertEqual(run.returncode, 2, run.stderr)
        for text in texts:
            self.assertIn(text, run.stderr)
        self.assertFalse((self.folder / "ranks").exists())

    def test_more_ranks_than_resources(self):
        self.refused(self.over(3, ["topology.resources=2"]), "topology.resources", "rank 2 would have none")
        self.refused(self.over(3, ["rays.slots_per_resource=2"]), "rays.slots_per_resource", "rank 2 would have none")

    def test_ranks_of_other_configurations(self):
        one = self.command("ranks", ["engine.transport=mpi"])
        other = self.command("ranks", ["engine.transport=mpi", "image.seed=7"])
        self.refused(self.side_by_side(one, other), "rank 1 has another configuration", "seed: 7")

    def side_by_side(self, *commands):
        """Runs a command a rank."""
        words = [word for command in commands for word in (":", "-n", "1", *command)][1:]
        return subprocess.run(["mpirun", *words], capture_output=True, text=True, timeout=60, env=ENVIRONMENT)

    def test_ranks_of_other_programs(self):
        version = subprocess.run([CAROUSEL, "--version"], capture_output=True, text=True, check=True).stdout
        commit = re.search(r"\b[0-9a-f]{7,40}\b", version)
        if commit is None:
            self.skipTest("the program does not know its commit")
        commit = commit[0].encode()
        # The compiler may have made two words of it, in instructions, that overlap.
        pieces = re.compile(re.escape(commit) + b"|" + re.escape(commit[:4]) + b"(?=.{0,16}" + re.escape(commit[3:7]) + b")", re.S)
        # A program takes modules of its own build only, so that the other one has one too, as where it is installed.
        other, module = self.folder / "bin" / "carousel", self.folder / "lib" / "carousel" / "modules" / "mpi.so"
        for target, source in (other, pathlib.Path(CAROUSEL)), (module, pathlib.Path(CAROUSEL).parent / "modules" / "mpi.so"):
            content, places = pieces.subn(lambda at: b"zzzz" + at[0][4:], source.read_bytes())
            if places == 0:
                self.skipTest(f"the commit cannot be found in {source}")
            target.parent.mkdir(parents=True)
            target.write_bytes(content)
            target.chmod(0o755)
        command = self.command("ranks", ["engine.transport=mpi"])
        self.refused(self.side_by_side(command, command, [str(other), *command[1:]]), "rank 2 has another program")

    def test_a_program_without_the_module(self):
        run = subprocess.run(self.command("ranks", ["engine.transport=mpi"]), capture_output=True, text=True, timeout=60,
                             env=dict(ENVIRONMENT, CAROUSEL_MODULES=str(self.folder)))
        self.refused(run, "engine.transport: the module mpi is not there", "carousel-mpi", "libopenmpi-dev",
                     "expected local, found mpi")

    def test_files_that_a_rank_does_not_have(self):
        """Two hosts, played by two folders with the same configuration."""
        triangle = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                                   "min": [0, 0, 0], "max": [1, 1, 0]}],
                    "bufferViews": [{"buffer": 0, "byteLength": 36}],
                    "buffers": [{"uri": "points.bin", "byteLength": 36}]}
        commands = []
        for host in "one", "other":
            (self.folder / host).mkdir()
            config = self.folder / host / "machine.yaml"
            config.write_text(MACHINE.replace("builtin: terrain, triangles: 2000", "file: scene.gltf"))
            commands.append([str(config) if word == str(self.config) else word
                             for word in self.command("ranks", ["engine.transport=mpi"])])
            (self.folder / host / "points.bin").write_bytes(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        scene = self.folder / "one" / "scene.gltf"
        scene.write_text(json.dumps(triangle))
        self.refused(self.side_by_side(*commands), "rank 1: cannot read", "scene.gltf")
        self.refused(self.side_by_side(*reversed(commands)), "rank 0: cannot read", "scene.gltf")
        shutil.copy(scene, self.folder / "other")
        self.assertEqual(self.side_by_side(*commands).returncode, 0)
        shutil.rmtree(self.folder / "ranks")
        (self.folder / "other" / "points.bin").write_bytes(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 2, 0))
        self.refused(self.side_by_side(*commands), "rank 1 has another content of the scene's files")
        (self.folder / "other" / "points.bin").unlink()
        self.refused(self.side_by_side(*commands), "rank 1 has another content of the scene's files")

    def test_what_ranks_do_not_carry(self):
        for assignment in ("faults.links.drop=0.1", "bundles.size=4", "rays.placement=first_taker", "verify=reference",
                           "engine.kind=cycle"):
            refusal = self.alone(["engine.transport=mpi", assignment])
            self.assertEqual(refusal.returncode, 2)
            self.assertIn("engine.transport: local", refusal.stderr)

    def test_what_no_run_survives(self):
        for recover in "true", "false":
            refusal = self.alone(["engine.transport=mpi", "faults.resource.kind=stop", f"faults.resource.recover={recover}"])
            self.assertEqual(refusal.returncode, 2)
            self.assertIn("no run survives the loss of a rank", refusal.stderr)

    def test_commands_for_one_process(self):
        run = subprocess.run([CAROUSEL, "follow", str(self.config), "--ray", "0", *sets(["engine.transport=mpi"])],
                             capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("engine.transport", run.stderr)
        refusal = subprocess.run(self.command("ranks", ["engine.transport=mpi"]) + ["--hits"], capture_output=True,
                                 text=True, timeout=60)
        self.assertEqual(refusal.returncode, 2)
        self.assertIn("--hits", refusal.stderr)


def read_trace(name):
    """Returns a trace, its events, the names of its processes, and when messages were sent and received, by
    (from, to, number)."""
    trace = json.loads(name.read_text())
    events = trace["traceEvents"]
    processes = {event["pid"]: event["args"]["name"] for event in events if event["name"] == "process_name"}
    threads = {(event["pid"], event["tid"]): event["args"]["name"] for event in events if event["name"] == "thread_name"}
    messages = {"send": {}, "receive": {}}
    for event in events:
        if event["ph"] != "X" or event["name"] not in messages:
            continue
        own = int(processes[event["pid"]].removeprefix("rank "))
        other = int(threads[event["pid"], event["tid"]].split()[-1])
        ends = (own, other) if event["name"] == "send" else (other, own)
        messages[event["name"]][*ends, event["args"]["message"]] = event["ts"]
    return trace, events, processes, messages


class WhatRanksReport(Ranks):
    def test_waiting_and_back_pressure(self):
        """Ranks whose links hold one packet wait for one another."""
        table = subprocess.run(["mpirun", "-n", "2", *(word for word in self.command("ranks", ["engine.transport=mpi",
                                "topology.link.depth=1"]) if word != "--quiet")], capture_output=True, text=True,
                               timeout=120, env=ENVIRONMENT)
        self.assertEqual(table.returncode, 0, table.stderr)
        self.counted(2)
        report = self.report("ranks")
        for rank in report["ranks"]:
            self.assertGreater(rank["waiting"], 0.01)
            self.assertLessEqual(rank["waiting"], 1)
            self.assertRegex(table.stdout, rf"rank {rank['rank']}: resources {rank['first_resource']} to .* waited ")
        for way in report["rank_links"]:
            self.assertGreater(way["full"], 0)
            self.assertRegex(table.stdout, rf"rank {way['from']} to {way['to']}: {way['messages']:,} messages .* "
                             rf"{way['packets_per_message']:.1f} packets a message .* full {way['full']:,} times")


class OneTimeline(Ranks):
    def trace(self, ranks, before=lambda rank: []):
        """Runs with a timeline, each rank's command behind words of its own."""
        command = self.command("ranks", ["engine.transport=mpi"]) + ["--force", "--trace", str(self.folder / "trace.json")]
        words = [word for rank in range(ranks) for word in (":", "-n", "1", *before(rank), *command)][1:]
        return subprocess.run(["mpirun", *words], capture_output=True, text=True, timeout=120, env=ENVIRONMENT)

    def check(self, ranks, before=lambda rank: []):
        run = self.trace(ranks, before)
        self.assertEqual(run.returncode, 0, run.stderr)
        trace, events, processes, messages = read_trace(self.folder / "trace.json")
        self.assertEqual(sorted(processes.values()), [f"rank {rank}" for rank in range(ranks)])
        kinds = {rank: set() for rank in processes.values()}
        for event in events:
            if event["ph"] == "X":
                kinds[processes[event["pid"]]].add(event["name"])
        for rank, found in kinds.items():
            self.assertLessEqual({"issue", "visit", "retire", "packet", "send", "receive"}, found, rank)
        clocks = trace["otherData"]["clocks"]
        self.assertEqual([clock["rank"] for clock in clocks], list(range(ranks)))
        unsure = [clock["uncertainty_us"] for clock in clocks]
        self.assertEqual(messages["send"].keys(), messages["receive"].keys())
        for message, begin in messages["send"].items():
            self.assertGreaterEqual(messages["receive"][message], begin - unsure[message[0]] - unsure[message[1]] - 0.001)
        report = self.report("ranks")
        self.assertEqual(len(messages["send"]), sum(link["messages"] for link in report["rank_links"]))
        # The ways of packets lead through ranks, and each has one beginning and one end.
        ways = {}
        for event in events:
            if event["ph"] in "stf":
                ways.setdefault((event["cat"], event["id"]), []).append((event["ph"], event["pid"]))
        for way in ways.values():
            self.assertEqual("".join(phase for phase, _ in way), "s" + (len(way) - 2) * "t" + "f")
        packets = [way for (kind, _), way in ways.items() if kind == "packets"]
        self.assertGreater(sum(len({pid for _, pid in way}) == ranks for way in packets), len(packets) / 2)
        return clocks

    def test_on_one_host(self):
        for clock in self.check(3):
            self.assertEqual((clock["ahead_us"], clock["uncertainty_us"]), (0, 0))

    def test_with_a_clock_of_its_own(self):
        """A time namespace plays a host that was started a day later."""
        later = ["unshare", "--time", "--monotonic", "86400"]
        try:
            if subprocess.run([*later, "true"], capture_output=True, timeout=60).returncode != 0:
                self.skipTest("this process may not make time namespaces")
        except OSError:
            self.skipTest("there is no unshare")
        clocks = self.check(2, lambda rank: later if rank == 1 else [])
        self.assertEqual((clocks[0]["ahead_us"], clocks[0]["uncertainty_us"]), (0, 0))
        self.assertGreater(clocks[1]["uncertainty_us"], 0)
        self.assertLess(clocks[1]["uncertainty_us"], 1e6)
        self.assertLessEqual(abs(clocks[1]["ahead_us"] - 86400e6), clocks[1]["uncertainty_us"] + 0.001)

    def test_ranks_that_note_different_things(self):
        command = self.command("ranks", ["engine.transport=mpi"])
        run = subprocess.run(["mpirun", "-n", "1", *command, ":", "-n", "1", *command, "--trace",
                              str(self.folder / "trace.json")], capture_output=True, text=True, timeout=60, env=ENVIRONMENT)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("rank 1 has another --trace", run.stderr)
        self.assertFalse((self.folder / "trace.json").exists())


class Failures(Ranks):
    def begin(self, assignments=LONG, seconds=3, options=()):
        """A run of three ranks that lasts long; returns it and the processes of its ranks, by rank, after `seconds`."""
        command = ["mpirun", *options, "-n", "3", *self.command("ranks", ["engine.transport=mpi", *assignments])]
        run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.addCleanup(run.kill)
        ranks = {}
        until = time.time() + 60
        while len(ranks) < 3 and time.time() < until:
            for process in pathlib.Path("/proc").glob("[0-9]*"):
                try:
                    command = (process / "cmdline").read_bytes().split(b"\0")
                    words = (process / "environ").read_bytes().split(b"\0")
                except OSError:
                    continue
                if str(self.folder / "ranks").encode() not in command or not command[0].endswith(b"carousel"):
                    continue
                for word in words:
                    if word.startswith(b"OMPI_COMM_WORLD_RANK="):
                        ranks[int(word.split(b"=")[1])] = int(process.name)
            time.sleep(0.02)
        self.assertEqual(len(ranks), 3)
        time.sleep(seconds)  # the run has begun
        self.assertIsNone(run.poll())
        return run, ranks

    def ended(self, run, seconds):
        begin = time.time()
        _, text = run.communicate(timeout=60)
        self.assertLess(time.time() - begin, seconds, text)
        self.assertNotEqual(run.returncode, 0)
        self.assertFalse((self.folder / "ranks").exists())
        return text

    def test_a_rank_that_is_killed(self):
        run, ranks = self.begin()
        os.kill(ranks[1], signal.SIGKILL)
        self.assertIn("rank 1", self.ended(run, 30))

    def test_a_signal_to_one_rank_ends_all_with_its_status(self):
        run, ranks = self.begin(seconds=1)
        os.kill(ranks[1], signal.SIGTERM)
        _, text = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 128 + signal.SIGTERM, text)
        self.assertTrue(self.report("ranks")["incomplete"])

    def test_a_rank_that_hangs(self):
        run, ranks = self.begin()
        os.kill(ranks[2], signal.SIGSTOP)
        text = self.ended(run, 45)
        self.assertEqual(run.returncode, 1, text)
        self.assertIn("rank 2 has said nothing", text)

    def stopped(self, run, process, lost):
        """The others end within seconds, and each of them names the rank."""
        os.kill(process, signal.SIGSTOP)
        text = self.ended(run, 30)
        self.assertEqual(run.returncode, 1, text)
        for rank in {0, 1, 2} - {lost}:
            self.assertIn(f"rank {rank}: error: rank {lost} has said nothing", text)

    def test_a_rank_that_hangs_before_rays_are_traced(self):
        """The others read a file that does not end, and are not waiting for it."""
        os.mkfifo(self.folder / "pipe.gltf")
        for way in some(["self,vader", "self,tcp"]):
            run, ranks = self.begin(["scene={file: pipe.gltf}"], 2, ("--mca", "btl", way))
            self.stopped(run, ranks[1], 1)

    def test_a_rank_that_hangs_before_it_has_joined(self):
        run, ranks = self.begin(seconds=0)
        os.kill(ranks[1], signal.SIGSTOP)
        text = self.ended(run, 30)
        self.assertEqual(run.returncode, 1, text)
        self.assertRegex(text, "rank 1 (is stopped|has said nothing)")

    @long_test
    def test_a_rank_that_hangs_while_files_are_written(self):
        """Rank 0 writes them, into a hidden folder first; the others wait for it."""
        large = ["image.width=400", "image.height=300", "image.samples=1", "image.max_depth=1", "engine.threads=1",
                 "rays.slots_per_resource=4096", "topology.link.depth=256"]
        run, ranks = self.begin(large, 0)
        while not list(self.folder.glob(".ranks.*/config.resolved.yaml")) and run.poll() is None:
            time.sleep(0.005)
        os.kill(ranks[0], signal.SIGSTOP)
        _, text = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, text)
        self.assertRegex(text, "rank 0 (is stopped|has said nothing)")
        if (self.folder / "ranks").exists():  # the last moment was gone, and they are whole
            self.assertEqual(self.alone(large).returncode, 0)
            self.assertEqual(self.digests("ranks"), self.digests("alone"))

    @long_test
    def test_a_rank_that_is_only_slow(self):
        """It reads a file for longer than a rank may be silent. Two hosts are two folders."""
        write_patches(self.folder / "scene.gltf", 1, 8)
        commands = []
        for host in "one", "other":
            (self.folder / host).mkdir()
            shutil.copy(self.folder / "scene.bin", self.folder / host)
            config = self.folder / host / "machine.yaml"
            config.write_text(MACHINE.replace("builtin: terrain, triangles: 2000", "file: scene.gltf"))
            commands.append([str(config) if word == str(self.config) else word
                             for word in self.command("ranks", ["engine.transport=mpi"])])
        shutil.copy(self.folder / "scene.gltf", self.folder / "one")
        slow = self.folder / "other" / "scene.gltf"
        os.mkfifo(slow)
        run = subprocess.Popen(["mpirun", "-n", "1", *commands[0], ":", "-n", "1", *commands[1]], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.addCleanup(run.kill)
        with slow.open("wb") as pipe:  # rank 1 reads it from here on
            time.sleep(8)
            self.assertIsNone(run.poll())
            content = (self.folder / "scene.gltf").read_bytes()
            os.replace(self.folder / "scene.gltf", slow)
            pipe.write(content)
        _, text = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 0, text)


if __name__ == "__main__":
    unittest.main()
