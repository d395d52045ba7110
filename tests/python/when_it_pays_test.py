"""bench/studies/when_it_pays with a program that only seems to simulate: what is killed goes on, shards share the runs and
end in time, each row takes the best of the splits that were found, and machines that differ in a hit are told. And what the
map says of a place."""
import itertools
import json
import math
import os
import pathlib
import re
import shutil
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
        "resolved": {"memory": {
            "dram": {"preset": keys.get("memory.dram.preset"), "channels": int(keys.get("memory.dram.channels", 1))}},
            "area": {"budget_mm2": float(keys["area.budget_mm2"])}}}))
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
    "engine": {"cycles": 1000 + number_of([sys.argv[2].split("/")[-1], *sets]) % 1000}, "rays": {"completed": 5000},
    "energy": {"nj_per_ray": 1 + number_of(sets) % 7}, "area": {"mm2": 40}, "structure": {"bytes": 500000},
    "config": {"topology": {"resources": 8 + number_of(sets) % 8}, "rays": {"slots_per_resource": 32}}}))
'''


class WhenItPays(unittest.TestCase):
    finished = None

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path, cls.copy = (pathlib.Path(folder.name) / name for name in ("here", "whole"))

    def setUp(self):
        shutil.rmtree(self.path, ignore_errors=True)
        self.path.mkdir()
        (self.path / "carousel").write_text(PROGRAM)
        (self.path / "carousel").chmod(0o755)

    def whole(self):
        """The study from nothing, and what it left: a second makes the same calls, so that it is made once and copied."""
        if WhenItPays.finished is None:
            WhenItPays.finished = self.study()
            shutil.copytree(self.path, self.copy)
        shutil.rmtree(self.path)
        shutil.copytree(self.copy, self.path)
        self.assertEqual(self.finished.returncode, 0, self.finished.stderr)
        return self.finished

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

    @staticmethod
    def kept(folder):
        return [json.loads(file.read_text()) for file in folder.glob("*.json")]

    def test_each_row_takes_the_best_split(self):
        self.whole()
        kept = self.kept(self.path / "out")
        found = [one for one in kept if "area.fit=best" in one["run"]["keys"]]
        self.assertEqual(len(found), 2 * (12 + 6), "with each width of memory all slots on one frame, the best of them on another")
        self.assertEqual(sum("list" in one["run"] for one in found), 2 * 6)
        number = lambda keys, name: next(int(key.split("=")[1]) for key in keys if key.startswith(name))
        splits = {(one["run"]["config"], number(one["run"]["keys"], "memory.dram.channels"), one["fitted"]["topology.resources"]) for one in found}
        for one in kept:
            keys = one["run"]["keys"]
            if one not in found:
                self.assertIn("area.fit=refuse", keys)
                self.assertIn((one["run"]["config"], number(keys, "memory.dram.channels"), number(keys, "topology.resources")), splits)
        # Of stacks, each frame: the second seed ran machines with the fewest cycles or joules of the first, with some number of slots, on
        # the least picture. Where that fills the slots, all kinds compete for speed.
        machine = lambda one: one["run"]["keys"][one["run"]["keys"].index("engine.threads=1") + 1:]
        ran_all = 0
        for least, channels in itertools.product(({"image.max_depth=1", "image.width=128"}, {"image.max_depth=4", "image.width=96"}), (1, 16)):
            frame, width = sorted(least)
            of_row = [one for one in kept if one not in found and {frame, f"memory.dram.channels={channels}"} <= set(one["run"]["keys"])]
            stacks = [one for one in of_row if one["run"]["config"] == "gpu_stack.yaml"]
            first = [one for one in stacks if {width, "image.seed=1"} <= set(one["run"]["keys"])]
            ran = [machine(one) for one in stacks if "image.seed=2" in one["run"]["keys"]]
            slots = lambda one: number(one["run"]["keys"], "rays.slots_per_resource")
            fewest, thrifty = ([machine(one) for one in first if one[what] == min(other[what] for other in first if slots(other) == slots(one))]
                               for what in ("cycles", "nj_per_ray"))
            self.assertTrue(all(one in fewest or one in thrifty for one in ran))
            if all(width in one["run"]["keys"] for one in of_row):
                self.assertTrue(any(one in fewest for one in ran))
                ran_all += 1
        self.assertGreater(ran_all, 0)

    def test_pictures_fill_the_slots(self):
        self.whole()
        rows = {}
        for one in self.kept(self.path / "out"):
            keys = dict(key.split("=", 1) for key in one["run"]["keys"])
            if "list" in one["run"] and keys["area.fit"] != "best":
                _, _, rays, size, seed = one["run"]["list"]["name"].split("-")
                slots = int(keys["rays.slots_per_resource"]) * int(keys["topology.resources"])
                machine = {"ring": "ring" in one["run"]["config"], "slots": slots, "cycles": one["cycles"], "nj_per_ray": one["nj_per_ray"]}
                rows.setdefault((rays, keys["memory.dram.channels"]), {}).setdefault(size, {}).setdefault(int(seed), []).append(machine)
        larger = 0
        for (rays, _), sizes in rows.items():
            trials, least, most = sizes.pop("96x64")[1], 0, 0
            for ring, what in itertools.product((True, False), ("cycles", "nj_per_ray")):
                some = [one for one in trials if one["ring"] == ring]
                best = [one["slots"] for one in some if one[what] == min(other[what] for other in some)]
                least, most = max(least, min(best)), max(most, max(best))  # of as good ones any
            a_pixel = {"shadow": 0.88, "shuffled": 0.85}[rays]
            self.assertLessEqual(len(sizes), 1)
            self.assertTrue(sizes or 96 * 64 * a_pixel >= 20 * least)
            for size, seeds in sizes.items():
                width, height = map(int, size.split("x"))
                self.assertGreaterEqual(width * height * a_pixel, 20 * least)
                self.assertLess((width - 8) * (height - 8) * a_pixel, 20 * most)
                self.assertEqual({one["ring"] for one in seeds[1]}, {True, False})
                self.assertEqual({one["ring"] for one in seeds[2]}, {True, False})
                larger += 1
        self.assertGreater(larger, 0)

    def test_a_killed_study_goes_on(self):
        whole = self.whole()
        all_runs = self.calls()
        said = len(all_runs)
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
        self.assertEqual(self.study("--shard", "1/3").returncode, 75, "the others still search")
        first = self.machines(self.calls())
        self.assertEqual(len(first), 12 * 2 // 3)
        seen, left = first, {"2/3", "3/3", "1/3"}
        while left:
            for shard in sorted(left):
                done = self.study("--shard", shard)
                self.assertIn((done.returncode, done.stdout), ((0, ""), (75, "")), done.stderr)
                seen += self.machines(self.calls())
                left -= {shard} if done.returncode == 0 else set()
        self.assertEqual(len(set(seen)), len(seen))
        self.assertIn("| terrain | camera |", self.study().stdout)
        self.assertEqual(self.calls(), [])

    def test_a_shard_ends_in_time(self):
        late = self.study("--hours", "0")
        self.assertEqual(late.returncode, 75)
        self.assertEqual(self.calls(), [])
        counted = self.study("--count")
        self.assertEqual(counted.returncode, 0)
        self.assertEqual(self.calls(), [])
        self.assertRegex(counted.stderr, r"first searches: 24 runs are left of 24, some \d+\.\d hours of one core, by a guess")

    def test_runs_of_another_commit_are_not_taken_unasked(self):
        whole = self.whole()
        runs = len(self.calls())
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
        self.assertIn("expected 2 to 5", self.study("--grid", "small", "--seeds", "6").stderr)
        whole = self.whole()
        self.calls()
        self.assertEqual(self.study("--seeds", "2").stdout, whole.stdout)
        self.assertEqual(self.calls(), [])

    def test_rows_have_the_seeds_that_are_kept(self):
        def seeds_of(table):
            return {tuple(cell.strip() for cell in line.split("|")[2:6:2]): line.split("|")[5].strip() for line in table.splitlines()[2:]}
        whole = self.whole()
        self.calls()
        seeds = seeds_of(whole.stdout)
        rays, channels = next(row for row, number in seeds.items() if number == "2")
        of_row = {"camera": lambda run: "image.max_depth=1" in run["keys"], "bounces": lambda run: "image.max_depth=4" in run["keys"]}.get(
            rays, lambda run: f"-{rays}-" in run.get("list", {}).get("name", ""))
        for file in (self.path / "out").glob("*.json"):
            run = json.loads(file.read_text())["run"]
            if of_row(run) and f"memory.dram.channels={channels}" in run["keys"] and (
                    "image.seed=2" in run["keys"] or run.get("list", {}).get("name", "").endswith("-2")):
                file.unlink()
        done = self.study("--kept")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.calls(), [])
        self.assertEqual(seeds_of(done.stdout), seeds | {(rays, channels): "1"})
        for file in (self.path / "out").glob("*.json"):
            file.unlink()
        self.assertIn("first searches are missing", self.study("--kept").stderr)

    def test_the_map_is_asked_for_machines_beyond_it(self):
        self.whole()
        self.calls()
        done = self.study("--beyond")
        self.assertEqual(done.returncode, 0, done.stderr)
        calls = self.calls()
        self.assertEqual(len(calls), 12 * 2, "of each a ring and a conventional machine")
        self.assertTrue(all("area.fit=best" in call for call in calls))
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines() if line.startswith("| ")][1:]
        self.assertEqual(len(rows), 12)
        for *_, pair, choice, told, found, right in rows:
            ring, stack = pair.split(" over ")
            self.assertEqual(choice, ring if float(told) > 1 else stack)
            self.assertEqual(right, "yes" if (float(told) > 1) == (float(found) > 1) else "no")
        self.assertIn(f"Right: {sum(row[-1] == 'yes' for row in rows)} of 12.", done.stdout)

    def test_other_hits_are_told(self):
        lie = self.study(LIE_AT="7")
        self.assertEqual(lie.returncode, 1)
        self.assertIn("machines differ in a hit", lie.stderr)

    def test_lists_hold_one_kind_of_rays(self):
        self.whole()
        for kind, name in (("shadow", "shadow"), ("bounce", "shuffled")):
            files = sorted((self.path / "out/rays/abc12345").glob(f"*-{name}-*.csv"))
            self.assertEqual({file.stem.rsplit("-", 1)[1] for file in files}, {"1", "2"}, "a list for each seed")
            rows = [line.split(",") for line in files[0].read_text().splitlines()[1:]]
            self.assertEqual({row[1] for row in rows}, {kind})
            self.assertEqual([int(row[0]) for row in rows], list(range(20)))
            places = [int(row[4]) for row in rows]
            self.assertEqual(places == sorted(places), kind == "shadow")


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
        for place, ratio in rows.values():
            self.assertAlmostEqual(map_axes.ratio_at(rows, place), ratio)
        for row, (place, _) in rows.items():
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
            run = {"config": "gpu_stack.yaml", "keys": ["scene.triangles=60000", "memory.dram.preset=gddr6_14", "memory.dram.channels=4",
                                                        "area.budget_mm2=25"]}
            place = map_axes.place_of(program, run)
        self.assertAlmostEqual(place.tree, 50 * 60000 / 25)
        self.assertAlmostEqual(place.bandwidth, 4 * 28 / 25)


if __name__ == "__main__":
    unittest.main()
