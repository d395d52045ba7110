"""bench/studies/when_it_pays with a program that only seems to simulate: what is killed goes on, shards share the runs and
end in time, machines are tuned step by step, and those that differ in a hit are told. And what the map says of a place."""
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDY = ROOT / "bench/studies/when_it_pays"
sys.dont_write_bytecode = True
sys.path.insert(0, str(STUDY.parent))
import map_axes
import map_machines
import map_tuning

# Notes each call. Cycles follow from the machine, hits from scene and rays. KILL_AT kills the study in a call, and LIE_AT
# gives a call other hits. Thousands of calls: it starts without what Python searches, and imports little.
PROGRAM = f"#!{sys.executable} -IS\n" + '''
import json, os, signal, sys, zlib
if sys.argv[1:] == ["--version"]:
    print("carousel 1\\ncommit", os.environ.get("COMMIT", "abc12345"))
    sys.exit(0)
if sys.argv[1] == "check":
    keys = dict(word.split("=", 1) for before, word in zip(sys.argv, sys.argv[1:]) if before == "--set")
    print(json.dumps({
        "memory": {"parts": {"structure": 50 * int(keys.get("scene.triangles", 0))}},
        "resolved": {"topology": {"resources": 20}, "memory": {
            "shape_buffer_kib": 32, "l1_kib": 4, "l2_kib": int(keys.get("memory.l2_kib", 512)), "shared_by": 8,
            "dram": {"channels": int(keys.get("memory.dram.channels", 1))}}}}))
    sys.exit(0)
calls = os.path.dirname(os.path.abspath(__file__)) + "/calls"
with open(calls, "a+") as file:
    file.write(json.dumps(sys.argv[1:]) + "\\n")
    file.seek(0)
    number = len(file.read().splitlines())
if number == int(os.environ.get("KILL_AT", 0)):
    os.kill(os.getppid(), signal.SIGKILL)
if "--dump-rays" in sys.argv:
    rows = ["ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax"]
    rows += [f"{i},{('camera', 'bounce', 'shadow')[i % 3]},0,0,{i},0,0,1,0,inf" for i in range(60)]
    with open(sys.argv[sys.argv.index("--dump-rays") + 1], "w") as file:
        file.write("\\n".join([*rows, "# end of 60", ""]))
    sys.exit(0)
sets = [word.split("/")[0] + word.split("/")[-1] for before, word in zip(sys.argv, sys.argv[1:]) if before == "--set"]
rays = [word for word in sets if word.startswith(("scene.", "image.", "workload="))]
number_of = lambda words: zlib.crc32(json.dumps(words).encode()) % 2 ** 24
print(json.dumps({
    "digest": {"hits": "wrong" if number == int(os.environ.get("LIE_AT", 0)) else number_of(rays)},
    "engine": {"cycles": 1000 + number_of([sys.argv[2], *sets]) % 1000}, "rays": {"completed": 5000},
    "energy": {"nj_per_ray": 1 + number_of(sets) % 7}, "area": {"mm2": 40}, "structure": {"bytes": 500000},
    "config": {"topology": {"resources": 8}, "rays": {"slots_per_resource": 32}}}))
'''


class WhenItPays(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "carousel").write_text(PROGRAM)
        (self.path / "carousel").chmod(0o755)

    def study(self, *options, **environment):
        return subprocess.run([sys.executable, STUDY, "--grid", "try", "--build", self.path, "--out", self.path / "out", *options],
                              capture_output=True, text=True, env={**os.environ, **environment})

    def calls(self):
        """What was asked of the program since the last time: runs of machines, without those that make lists of rays."""
        file = self.path / "calls"
        calls = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
        file.unlink(missing_ok=True)
        return [call[1:] for call in calls if "--dump-rays" not in call]

    @staticmethod
    def machines(calls):
        """Without the folder of results, which is another one each time."""
        return [tuple(word for word in call if tempfile.gettempdir() not in word or "rays_from" in word) for call in calls]

    def test_the_best_split_is_found_once_and_kept(self):
        def shard(number):
            return subprocess.run([sys.executable, STUDY.parent / "best_split", "--build", self.path, "--out", self.path / "split",
                                   "--seeds", "2", "--shard", f"{number}/2"], capture_output=True, text=True).returncode
        self.assertEqual([shard(1), shard(2), shard(1)], [75, 0, 0])
        calls = [[word for before, word in zip(call, call[1:]) if before == "--set"] for call in self.calls()]
        searches = [call for call in calls if "area.fit=best" in call]
        rows = [call for call in calls if "area.fit=refuse" in call]
        self.assertEqual(len(searches) + len(rows), len(calls))
        self.assertEqual(len(searches), 3 * 12, "settings of each kind, with each width of memory")
        self.assertEqual(len(rows), 6 * 3 * 8 * 2, "kinds, widths, scenes with rays, seeds")
        for row in rows:
            self.assertIn("topology.resources=8", row)
        self.assertTrue(all("scene.builtin=terrain" in call and "image.seed=1" in call for call in searches))

    def test_a_killed_study_goes_on(self):
        whole = self.study()
        self.assertEqual(whole.returncode, 0, whole.stderr)
        all_runs = self.calls()
        said = int(re.search(r"(\d+) runs are left", whole.stderr)[1])
        self.assertEqual(len(all_runs), said)
        self.assertEqual(len(set(self.machines(all_runs))), said, "no run is made twice")
        self.assertEqual(whole.stdout.count("\n"), 2 + 4 * 2, "a row for each kind of rays and number of channels")
        again = self.study()
        self.assertEqual(again.stdout, whole.stdout)
        self.assertEqual(self.calls(), [])
        for file in (self.path / "out").glob("*.json"):
            file.unlink()
        killed = self.study(KILL_AT="20")
        self.assertEqual(killed.returncode, -signal.SIGKILL)
        kept = [json.loads(file.read_text()) for file in (self.path / "out").glob("*.json")]
        self.assertEqual(len(kept), len(self.calls()) - 1, "the run that was under way is not kept")
        rest = self.study()
        self.assertEqual(rest.stdout, whole.stdout)
        self.assertEqual(len(self.calls()), said - len(kept))

    def test_shards_share_the_runs(self):
        said, seen = None, []
        for shard in ("1/3", "2/3", "3/3"):
            done = self.study("--shard", shard)
            self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
            said = said or int(re.search(r"(\d+) runs are left", done.stderr)[1])
            mine = self.machines(self.calls())
            self.assertEqual(len(mine), said // 3)
            seen += mine
        self.assertEqual(len(set(seen)), said)
        self.assertEqual(len(seen), said)
        self.assertIn("| terrain | camera |", self.study().stdout)
        self.assertEqual(self.calls(), [])

    def test_a_shard_ends_in_time(self):
        late = self.study("--hours", "0")
        self.assertEqual(late.returncode, 75)
        self.assertEqual(self.calls(), [])
        counted = self.study("--count")
        self.assertEqual(counted.returncode, 0)
        self.assertEqual(self.calls(), [])
        self.assertRegex(counted.stderr, r"\d+ runs are left of 0 for tuning and \d+ for the map, some \d+\.\d hours")

    def test_runs_of_another_commit_are_not_taken_unasked(self):
        whole = self.study()
        runs = len(self.calls())
        self.assertEqual(whole.returncode, 0, whole.stderr)
        refused = self.study(COMMIT="def67890")
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assertIn(f"keeps runs of other commits than def67890: {runs} of abc12345", refused.stderr)
        taken = self.study("--others", "take", COMMIT="def67890")
        self.assertEqual((taken.returncode, taken.stdout), (0, whole.stdout))
        self.assertEqual(self.calls(), [])
        late = self.study("--others", "redo", COMMIT="def67890", KILL_AT="20")
        self.assertEqual(late.returncode, -signal.SIGKILL)
        self.assertEqual(len(self.calls()), 20)
        redone = self.study("--others", "redo", COMMIT="def67890")
        self.assertEqual((redone.returncode, redone.stdout), (0, whole.stdout))
        kept = [json.loads(file.read_text()) for file in (self.path / "out").glob("*.json")]
        self.assertEqual([one["commit"] for one in kept], ["def67890"] * runs)
        self.assertEqual(self.study(COMMIT="def67890").returncode, 0)
        # Of a file that tells no commit nothing is known.
        file = next((self.path / "out").glob("*.json"))
        file.write_text(json.dumps({key: value for key, value in kept[0].items() if key != "commit"}))
        self.assertIn("1 of unknown", self.study(COMMIT="def67890").stderr)

    def test_a_map_grows_seed_by_seed(self):
        self.assertIn("expected 2 to 2 with this grid", self.study("--seeds", "1").stderr)
        self.assertEqual(self.study("--seeds", "2").stdout, self.study().stdout)
        self.assertIn("expected 2 to 5", self.study("--grid", "small", "--seeds", "6").stderr)
        left = [int(re.search(r"(\d+) for the map", self.study("--grid", "small", "--count", *seeds).stderr)[1])
                for seeds in (["--seeds", "2"], ["--seeds", "3"], [])]
        self.assertEqual(left[1] - left[0], 8 * 9 * 6, "frames, sizes and channels, kinds")
        self.assertEqual(left[2] - left[1], 2 * 8 * 9 * 6)

    def test_other_hits_are_told(self):
        lie = self.study(LIE_AT="7")
        self.assertEqual(lie.returncode, 1)
        self.assertIn("machines differ in a hit", lie.stderr)

    def test_lists_hold_one_kind_of_rays(self):
        self.assertEqual(self.study().returncode, 0)
        for kind, name in (("shadow", "shadow"), ("bounce", "shuffled")):
            files = sorted((self.path / "out/rays/abc12345").glob(f"*-{name}-*.csv"))
            self.assertEqual(len(files), 2, "a list for each seed")
            rows = [line.split(",") for line in files[0].read_text().splitlines()[1:]]
            self.assertEqual({row[1] for row in rows}, {kind})
            self.assertEqual([int(row[0]) for row in rows], list(range(20)))
            places = [int(row[4]) for row in rows]
            self.assertEqual(places == sorted(places), kind == "shadow")


class Kept:
    """Runs whose cycles follow from the slots: those of the settings are the fewer, the nearer slots are to `best`."""

    def __init__(self, best):
        self.best, self.kept = best, set()

    def do(self, runs):
        self.kept |= {json.dumps(run) for run in runs}
        return True

    def missing(self, runs):
        return [run for run in runs if json.dumps(run) not in self.kept]

    def read(self, run):
        assert json.dumps(run) in self.kept, "only what was asked for is read"
        slots = map_tuning.slots(run["keys"])
        list_of = run.get("list", {"keys": run["keys"]})
        best = self.best("scene.builtin=spheres" in list_of["keys"], "list" in run, run["config"])
        return {"rays": 1, "cycles": 1000 * (1 + abs(math.log(slots / best))), "nj_per_ray": slots, "tree_bytes": 1}


class Tuning(unittest.TestCase):
    GRID = map_machines.Grid((10000,), (1,), (("terrain", "bounces"), ("terrain", "shadow"), ("spheres", "shadow"), ("spheres", "shuffled")),
                             (1, 2), (16, 8), (16, 8))

    def tuned(self, best):
        runs = Kept(best)
        self.assertIsNone(map_tuning.tune(runs, self.GRID)[1])
        tuning, machines = map_tuning.tune(runs, self.GRID, do=True)
        self.assertEqual(len({json.dumps(run) for run in tuning}), len(runs.kept), "each is done once")
        return len(tuning), {where: map_tuning.slots(machine) for where, machine in machines.items()}

    def test_each_frame_gets_its_best(self):
        """Stacks want 8 slots with bounces on the terrain, more with lists and with spheres; shuffled rays are not tuned by
        themselves, and warps are always far behind."""
        number, machines = self.tuned(lambda spheres, lists, config: 1e9 if config == "warp_stack.yaml" else
                                      8 * (8 if spheres else 1) * (4 if lists else 1))
        for scene, rays, best in (("terrain", "bounces", 8), ("terrain", "shadow", 32), ("spheres", "shuffled", 8),
                                  ("spheres", "shadow", 256)):
            self.assertEqual(machines["area", (scene, rays), "stacks", 10000, 1], best)
        # Joules are least with the fewest slots.
        self.assertEqual({machines["energy", frame, "stacks", 10000, 1] for frame in self.GRID.frames}, {4})
        self.assertEqual(machines["area", ("terrain", "bounces"), "repacked warps", 10000, 1], 1024)
        all_of_them = 4 * sum(len(map_machines.settings(kind, self.GRID)) for kind in map_machines.KINDS)
        self.assertLess(number, all_of_them)

    def test_what_is_far_behind_is_tuned_no_further(self):
        """With warps 8 slots are best, of which they have none: their 32 are 2.4 times as slow as the best stacks."""
        number, machines = self.tuned(lambda spheres, lists, config: 8)
        self.assertEqual({machines["area", frame, "stacks in warps", 10000, 1] for frame in self.GRID.frames}, {32})
        self.assertEqual(number, 34 + 2 * (4 * 3 + 2) + 6,
                         "all of one frame; of two 4, 8 and 16 slots, and the least warps; of shuffled rays no more than the best")


    def test_where_no_ring_is_near_nothing_is_tuned(self):
        number, machines = self.tuned(lambda spheres, lists, config: 1e6 if config == "ring_distributed.yaml" else 16 if lists else 8)
        self.assertEqual({machines["area", frame, "stacks", 10000, 1] for frame in self.GRID.frames}, {8})
        self.assertEqual(number, 34 + 3 * 6, "all of one frame, and its best on three others")


class Places(unittest.TestCase):
    """What the map says of a place, where it can be told otherwise."""

    @staticmethod
    def rows(ratio):
        """Trees and widths of memory of 1, 10, 100 and 1, 4; the ratio is a function of place."""
        places = {(trees, channels): map_axes.Place(trees * (1.1 if channels == 4 else 1), channels / 2)
                  for trees in (1, 10, 100) for channels in (1, 4)}
        return {row: (place, ratio(place)) for row, place in places.items()}

    def test_rows_say_what_they_are(self):
        rows = self.rows(lambda place: 0.3 + place.tree / 90 + place.bandwidth)
        for row, (place, ratio) in rows.items():
            self.assertAlmostEqual(map_axes.ratio_at(rows, place), ratio)
            self.assertEqual(map_axes.nearest_row(rows, place), row)

    def test_a_power_law_is_found_between_rows(self):
        rows = self.rows(lambda place: 0.9 * place.tree ** 0.2 * place.bandwidth ** -0.3)
        for tree, bandwidth in ((3, 0.5), (3, 1.3), (70, 2), (1.2, 0.6)):
            self.assertAlmostEqual(map_axes.ratio_at(rows, map_axes.Place(tree, bandwidth)), 0.9 * tree ** 0.2 * bandwidth ** -0.3)
        edge = map_axes.ratio_at(rows, map_axes.Place(3, 2))
        self.assertAlmostEqual(map_axes.ratio_at(rows, map_axes.Place(3, 50)), edge, msg="beyond the ends those of the ends")

    def test_only_the_rows_on_both_sides_count(self):
        rows = self.rows(lambda place: math.exp(abs(math.log(place.tree / 10))))
        for tree in (10 ** 1.5, 10 ** 0.5):
            self.assertAlmostEqual(map_axes.ratio_at(rows, map_axes.Place(tree, 0.5)), 10 ** 0.5)

    def test_a_machine_stands_where_its_configuration_says(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "carousel"
            program.write_text(PROGRAM)
            program.chmod(0o755)
            run = {"config": "gpu_stack.yaml", "keys": ["scene.triangles=60000", "memory.dram.channels=4", "memory.l2_kib=256"]}
            place = map_axes.place_of(program, run)
        self.assertAlmostEqual(place.tree, 50 * 60000 / 1024 / (20 * (32 + 4) + 3 * 256), msg="20 units share three caches")
        self.assertAlmostEqual(place.bandwidth, 4 * 12.8 / 20)


if __name__ == "__main__":
    unittest.main()
