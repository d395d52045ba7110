"""bench/studies/shipped_verdicts with a program that only seems to simulate: which verdicts count as the same one, which
configurations its table has, and which part of them a round of the soak runs."""
import importlib.machinery
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDY = ROOT / "bench/studies/shipped_verdicts"
sys.dont_write_bytecode = True
sys.path.insert(0, str(STUDY.parent))
loader = importlib.machinery.SourceFileLoader("shipped_verdicts", str(STUDY))
study = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(study)

# Answers with one of ANSWERS: those of seeds 1 to 5, and that of the large picture. A class with an equals sign has the
# rivals behind it, and a group; a question mark is a run that finds nothing out.
PROGRAM = f"#!{sys.executable} -IS\n" + '''
import json, os, sys
keys = dict(word.split("=", 1) for before, word in zip(sys.argv, sys.argv[1:]) if before == "--set")
answer = os.environ["ANSWERS"].split()[int(keys.get("image.seed", 6)) - 1]
name, _, rivals = answer.partition("=")
limits = "" if name in ("?", "none") else name
print(json.dumps({
    "config": {"image": {"width": 30, "height": 20}},
    "bottleneck": {"limits": limits, "rivals": rivals.split(",") if rivals else [], "group": "testers" if rivals else "",
                   "verdict": "no class of parts limits it alone: ..." if name == "none" else "not found out: ...",
                   "gains": [{"name": limits, "gain": 0.123}] if limits else []}}))
'''


class ShippedVerdicts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="carousel_verdicts_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        program = self.folder / "carousel"
        program.write_text(PROGRAM)
        program.chmod(0o755)

    def study(self, answers, *options):
        return subprocess.run([sys.executable, "-B", STUDY, "--build", self.folder, *options], capture_output=True, text=True,
                              env=dict(os.environ, ANSWERS=answers))

    def test_the_same_class_six_times_is_right_and_any_other_is_not(self):
        right = self.study("shading " * 6, "nearest")
        self.assertEqual(right.returncode, 0, right.stderr)
        self.assertIn("| `nearest` | 30 x 20 | shading 5 of 5 | +12, +12, +12, +12, +12 | shading | +12 |", right.stdout)
        self.assertIn("\n6 verdicts\n", right.stdout)
        for at in (1, 5):
            answers = ["shading"] * 6
            answers[at] = "dispatch"
            self.assertEqual(self.study(" ".join(answers), "nearest").returncode, 1, at)

    def test_nothing_found_out_is_wrong_but_that_no_class_limits_is_a_verdict(self):
        self.assertEqual(self.study("? " * 6, "nearest").returncode, 1)
        none = self.study("none " * 6, "nearest")
        self.assertEqual(none.returncode, 0)
        self.assertIn("| none alone 5 of 5 | -, -, -, -, - | none alone | - |", none.stdout)
        self.assertEqual(self.study("none none none none none ?", "nearest").returncode, 1)

    def test_classes_of_one_group_that_a_run_cannot_tell_apart_count_as_one(self):
        tied = self.study("a=b a a b=a b a=b", "nearest")
        self.assertEqual(tied.returncode, 0)
        self.assertIn("| a 3 of 5, b 2 of 5 (all: testers) |", tied.stdout)
        self.assertEqual(self.study("a=b a a b=a c a=b", "nearest").returncode, 1)
        self.assertEqual(self.study("a a a b b a", "nearest").returncode, 1)
        self.assertEqual(self.study("a=b a a ? b a", "nearest").returncode, 1)

    def test_a_wrong_one_has_its_row(self):
        row = self.study("a b ? none a b", study.CONFIGS[0])
        self.assertEqual(row.returncode, 1)
        self.assertIn("| a 2 of 5, b 1 of 5, not found out 1 of 5, none alone 1 of 5 |", row.stdout)

    def test_the_table_has_each_configuration_that_a_run_gives_a_verdict_on(self):
        asked = {file.stem for file in (ROOT / "configs").rglob("*") if file.suffix in (".yaml", ".json") and
                 not re.search(r"what_if: false|kind: native|traffic:|json-schema", file.read_text())}
        self.assertEqual(set(study.CONFIGS), asked)
        self.assertEqual(len(study.CONFIGS), len(asked))

    def test_a_part_has_each_eighth_of_them(self):
        part = self.study("shading " * 6, "--part", "7/8")
        self.assertEqual(tuple(re.findall(r"^\| `(\S+)` \|", part.stdout, re.M)), study.CONFIGS[7::8])


if __name__ == "__main__":
    unittest.main()
