"""Executes every command of the guides that have no test of their own, on small pictures, and sees that no guide is left out.
CAROUSEL names the program."""

import json
import re
import shutil
import struct
import unittest
from pathlib import Path

from page_commands import SOURCE, commands, reader, text_of

# Who runs the commands of a guide. Programs that a page builds need an installation; extending.md has headers for a compiler.
RUN_BY = {"tutorial": "tests/install/tutorial_test.py", "sweeps": "tests/python/sweeps_page_test.py",
          "draw-a-machine": "tests/python/draw_page_test.py", "plugins": "tests/install/install_test.py",
          "extending": "tests/docs/extending_test.cpp"}
SMALL = ("image: {width: 24, height: 15, samples: 1, max_depth: 3, seed: 1}", "scene: {builtin: spheres, triangles: 600}",
         "rays: {slots_per_resource: 64}")
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}
# Slurm's sbatch of a host that runs each job, and each of an array, when it is handed in.
SBATCH = """#!/bin/bash
set -euo pipefail
array=
while [[ $1 == --* ]]; do
  case $1 in --array=*) array=${1#--array=} ;; esac
  shift
done
if [ -z "$array" ]; then
  SLURM_NTASKS=2 bash "$@" >&2
else
  export SLURM_ARRAY_TASK_MIN=${array%-*}
  export SLURM_ARRAY_TASK_COUNT=$((${array#*-} - SLURM_ARRAY_TASK_MIN + 1))
  for i in $(seq "$SLURM_ARRAY_TASK_MIN" "${array#*-}"); do SLURM_ARRAY_TASK_ID=$i bash "$@" >&2; done
fi
echo 17
"""


def guides():
    return sorted(path.stem for path in (SOURCE / "docs/guides").glob("*.md"))


def glb():
    """A model of one triangle, at the node Chair."""
    points = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "Chair", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": len(points)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    }).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(points), b"BIN\0") + points
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Guides(unittest.TestCase):
    def run_guide(self, name, number, replaced=(), environment=None):
        """What the commands of a guide print, with configs/demo.yaml of a small scene, and text of commands replaced."""
        texts = commands(f"guides/{name}.md")
        self.assertEqual(len(texts), number)
        user = self.enterContext(reader())
        (user.folder / "configs").unlink()
        shutil.copytree(SOURCE / "configs", user.folder / "configs")
        demo = (SOURCE / "configs/demo.yaml").read_text()
        for line in SMALL:
            demo, count = re.subn(rf"^{line.partition(':')[0]}: .*$", line, demo, flags=re.M)
            self.assertEqual(count, 1, line)
        (user.folder / "configs/demo.yaml").write_text(demo)
        (user.folder / "my.glb").write_bytes(glb())
        user.put("sbatch", SBATCH)
        user.environment.update(environment or {})
        for old, new in replaced:
            self.assertTrue(any(old in text for text in texts), old)
            texts = [text.replace(old, new) for text in texts]
        return user, user.all(texts)

    def test_of_a_scene(self):
        _, printed = self.run_guide("scenes", 2)
        self.assertIn("Chair", printed[0])

    def test_of_comparisons(self):
        _, printed = self.run_guide("compare", 3)
        self.assertRegex(printed[0], r"hits +the same")
        self.assertRegex(printed[1], r"throughput\.whole\.rays_per_kilocycle")
        self.assertIn("6 points: 6 done, 0 failed", printed[2])

    def test_of_the_conventional_machine(self):
        small = "--seeds 2 --no-search --set image.width=16 --set image.height=12"
        _, printed = self.run_guide("versus", 1, [("--seeds 5", small)])
        self.assertRegex(printed[0], r"times as fast")

    def test_of_pages(self):
        user, _ = self.run_guide("pages", 1)
        self.assertIn("<html", (user.folder / "out/page/report.html").read_text())

    def test_of_timelines(self):
        user, printed = self.run_guide("timeline", 2)
        self.assertTrue(json.loads((user.folder / "trace.json").read_text())["traceEvents"])
        self.assertIn("is shaded", printed[1])

    def test_of_queues(self):
        few = "carousel stress --seconds 0.1 --messages 20 --repetitions 1 --pairs 0"
        _, printed = self.run_guide("queues", 1, [("carousel stress", few), ("--depths 1,4,16,64", "--depths 1,64")])
        self.assertEqual(printed[0].count("nothing lost, doubled, reordered or torn; nothing stuck"), 3)

    def test_of_a_cluster(self):
        if shutil.which("mpirun") is None:
            self.skipTest("there is no mpirun")
        few = [("topology.resources=64", "topology.resources=8"), ("slots_per_resource=65536", "slots_per_resource=64"),
               ("--cpus-per-task=16", "--cpus-per-task=1"), ("--array=1-8", "--array=1-2")]
        try:
            user, _ = self.run_guide("cluster", 4, few, MPI)
        except AssertionError as error:
            if "the module mpi is not there" in str(error):
                self.skipTest("the program has no module mpi")
            raise
        points = json.loads((user.folder / "out/sweep/sweep.json").read_text())["points"]
        self.assertEqual([point["status"] for point in points], ["done"] * 9)
        hits = {name: json.loads((user.folder / "out" / name / "report.json").read_text())["digest"]["hits"]
                for name in ("demo", "hosts", "parts")}
        self.assertEqual(len(set(hits.values())), 1, hits)

    def test_none_is_left_out(self):
        here = set(re.findall(r'run_guide\("([a-z-]+)"', Path(__file__).read_text()))
        for name in guides():
            with self.subTest(guide=name):
                self.assertNotEqual(name in here, name in RUN_BY, "one test runs the commands of a guide")
                if name in RUN_BY:
                    self.assertIn(f"guides/{name}.md", (SOURCE / RUN_BY[name]).read_text())
                # What is to be run says so.
                self.assertEqual(re.findall(r"^```\n(?:carousel|mpirun|sbatch) .*$", text_of(f"guides/{name}.md"), re.M), [])


if __name__ == "__main__":
    unittest.main()
