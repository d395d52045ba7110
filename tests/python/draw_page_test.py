"""Executes every command of docs/guides/draw-a-machine.md in turn, in a folder of its own. CAROUSEL names the
program."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


class DrawPage(unittest.TestCase):
    def test_every_block_works(self):
        page = (SOURCE / "docs" / "guides" / "draw-a-machine.md").read_text()
        blocks = re.findall(r"```sh\n(.*?)```", page, re.S)
        self.assertEqual(len(blocks), 13)
        printed = []
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bin").mkdir()
            (Path(folder) / "bin" / "carousel").symlink_to(os.environ["CAROUSEL"])
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
            for text in blocks:
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment,
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, text + done.stdout + done.stderr)
                printed.append(done.stdout)
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
        self.assertTrue(any(text.startswith("# busiest: bus") for text in printed))


if __name__ == "__main__":
    unittest.main()
