"""Runs the commands of docs/studies/floor-plans.md, with small pictures, on configs/floorplans. CAROUSEL names the program."""

import re
import unittest

from page_commands import SOURCE, commands, reader

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
        check, run = commands("studies/floor-plans.md")
        small = "--quiet --set image.width=32 --set image.height=20"
        self.assertEqual(run.count("--quiet"), 1)
        with reader() as user:
            printed = user.all((check, run.replace("--quiet", small)))
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
