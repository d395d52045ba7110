"""Runs the commands of docs/studies/floor-plans.md, with small pictures, on configs/floorplans. CAROUSEL names the program."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PLANS = ("gpu_two_partitions", "mesh_of_tiles", "package_of_four")


class FloorPlans(unittest.TestCase):
    def test_are_short_and_name_their_source(self):
        files = sorted((SOURCE / "configs/floorplans").glob("*.yaml"))
        self.assertEqual(tuple(file.stem for file in files), PLANS)
        for file in files:
            lines = file.read_text().splitlines()
            self.assertLess(len(lines), 60, file)
            comment = " ".join(line.lstrip("# ") for line in lines if line.startswith("#"))
            self.assertRegex(comment, r"After the (block diagram|basic design) of .*figure \d")

    def test_commands_of_the_page(self):
        page = (SOURCE / "docs/studies/floor-plans.md").read_text()
        check, run = re.findall(r"```sh\n(.*?)```", page, re.S)
        small = "--quiet --set image.width=32 --set image.height=20"
        self.assertEqual(run.count("--quiet"), 1)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bin").mkdir()
            (Path(folder) / "bin/carousel").symlink_to(os.environ["CAROUSEL"])
            (Path(folder) / "configs").symlink_to(SOURCE / "configs")
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
            printed = [subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment, check=True,
                                      capture_output=True, text=True).stdout
                       for text in (check, run.replace("--quiet", small))]
        # By hand: half of the pairs of clusters lie on both sides of the crossbar's link of 128 bytes; a cut through the
        # mesh has six links of 64, and one through the ring of modules two of 48. Each counts there and back.
        self.assertIn("# graph: 16 resources, 12 routers, 50 links of one way", printed[0])
        self.assertIn("# busiest: xbar[0] > xbar[1], on 64 of 256 ways", printed[0])
        self.assertIn("# halves: 256 bytes a cycle", printed[0])
        self.assertIn("# graph: 36 resources, 0 routers, 120 links of one way", printed[0])
        self.assertIn("# halves: 768 bytes a cycle", printed[0])
        self.assertIn("# graph: 16 resources, 4 routers, 40 links of one way", printed[0])
        self.assertIn("# halves: 192 bytes a cycle", printed[0])
        self.assertEqual(printed[0].count("# deadlock: impossible."), 3)
        # The module's ring is the narrow place of the package.
        for plan in PLANS:
            self.assertEqual(len(re.findall(rf"^{plan} ", printed[1], re.M)), 2)
        self.assertRegex(printed[1], r"package_of_four +xbar_. +> xbar_. ")


if __name__ == "__main__":
    unittest.main()
