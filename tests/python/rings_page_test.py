"""Executes every command of docs/studies/rings.md in turn, in a folder of its own. CAROUSEL names the program."""

import json
import unittest

from page_commands import commands, reader, text_of


class RingsPage(unittest.TestCase):
    def test_every_block_works(self):
        page = text_of("studies/rings.md")
        texts = commands("studies/rings.md")
        self.assertEqual(len(texts), 6)
        with reader() as user:
            printed = user.all(texts)
            traffic = {name: json.loads((user.folder / name / "report.json").read_text())["traffic"]
                       for name in ("eib", "free", "bridge", "far")}
        self.assertIn("may wait for as long as others keep its way full", printed[0])
        self.assertIn("no circle", printed[5])
        self.assertIn("a circle of", printed[5])
        # The table of the page.
        for name, published in (("eib", 204.8), ("free", 307.2)):
            ours = traffic[name]["gigabytes_per_second"]
            self.assertAlmostEqual(ours, published, delta=0.02 * published)
            self.assertIn(f"| {published} GB/s | {ours:.1f} GB/s |", page)
        self.assertEqual([traffic["bridge"]["least_latency"], traffic["bridge"]["latency"]["max"]], [26, 31])
        self.assertEqual(traffic["far"]["least_latency"], 31)


if __name__ == "__main__":
    unittest.main()
