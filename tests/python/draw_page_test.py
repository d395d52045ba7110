"""Executes every command of docs/guides/draw-a-machine.md in turn, in a folder of its own. CAROUSEL names the
program."""

import unittest

from page_commands import commands, reader, text_of


class DrawPage(unittest.TestCase):
    def test_every_block_works(self):
        page = text_of("guides/draw-a-machine.md")
        texts = commands("guides/draw-a-machine.md")
        self.assertEqual(len(texts), 15)
        with reader() as user:
            printed = user.all(texts)
        # The drawing on the page is what the program prints.
        self.assertIn(f"```\n{printed[0]}```", page)
        self.assertRegex(printed[1], "hits +the same")
        self.assertIn("# graph: 16 resources, 2 routers, 38 links of one way", printed[2])
        self.assertIn("# busiest: door[0] > door[1], on 64 of 256 ways", printed[2])
        self.assertIn("# deadlock: impossible.", printed[2])
        self.assertIn("# parts: 2 caches, 2 memories, 0 shading, 40 links that carry no packets", printed[3])
        self.assertIn("# ways to l2_left: 8 cycles at most, from left[0] to l2_left", printed[3])
        self.assertIn("# ways to memory: 42 cycles at most, from l2_left to dram[1]", printed[3])
        # The link between the dies limits the machine.
        self.assertRegex(printed[5], r"\Adoor\[\d\] +> door\[\d\] ")
        self.assertIn("# deadlock: impossible. no circle", printed[6])
        self.assertIn("# deadlock: impossible. virtual channels: a circle of ", printed[7])
        self.assertTrue(any("# halves: " in text and "# wires: " in text for text in printed))
        self.assertTrue(any("A  unlike" in text and "hits           the same" in text for text in printed))
        self.assertTrue(any("# packet processes: unit[0] serves r[0], r[1]" in text for text in printed))
        self.assertTrue(any(text.startswith("# busiest: bus") for text in printed))


if __name__ == "__main__":
    unittest.main()
