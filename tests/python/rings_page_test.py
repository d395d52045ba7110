"""Executes every command of docs/studies/rings.md in turn, in a folder of its own. CAROUSEL names the program."""

import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


class RingsPage(unittest.TestCase):
    def test_every_block_works(self):
        page = (SOURCE / "docs" / "studies" / "rings.md").read_text()
        blocks = re.findall(r"```sh\n(.*?)```", page, re.S)
        self.assertEqual(len(blocks), 5)
        printed = []
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bin").mkdir()
            (Path(folder) / "bin" / "carousel").symlink_to(os.environ["CAROUSEL"])
            (Path(folder) / "configs").symlink_to(SOURCE / "configs")
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}
            for text in blocks:
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment,
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, text + done.stdout + done.stderr)
                printed.append(done.stdout)
            traffic = {name: json.loads((Path(folder) / name / "report.json").read_text())["traffic"]
                       for name in ("eib", "free", "bridge", "far")}
        self.assertIn("may wait for as long as others keep its way full", printed[0])
        # The table of the page.
        for name, published in (("eib", 204.8), ("free", 307.2)):
            ours = traffic[name]["gigabytes_per_second"]
            self.assertAlmostEqual(ours, published, delta=0.02 * published)
            self.assertIn(f"| {published} GB/s | {ours:.1f} GB/s |", page)
        self.assertEqual([traffic["bridge"]["least_latency"], traffic["bridge"]["latency"]["max"]], [26, 31])
        self.assertEqual(traffic["far"]["least_latency"], 31)


if __name__ == "__main__":
    unittest.main()
