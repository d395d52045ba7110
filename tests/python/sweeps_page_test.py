"""Executes every command and every Python block of docs/guides/sweeps.md, in a folder of its own. CAROUSEL names
the program."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


class SweepsPage(unittest.TestCase):
    def test_every_block_works(self):
        page = (SOURCE / "docs" / "guides" / "sweeps.md").read_text()
        blocks = re.findall(r"```(sh|python)\n(.*?)```", page, re.S)
        self.assertGreaterEqual(len(blocks), 6)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "configs").symlink_to(SOURCE / "configs")
            (Path(folder) / "bin").mkdir()
            (Path(folder) / "bin" / "carousel").symlink_to(os.environ["CAROUSEL"])
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "PYTHONPATH": str(SOURCE / "python")}
            for language, text in blocks:
                words = ["bash", "-euo", "pipefail", "-c", text] if language == "sh" else [sys.executable, "-c", text]
                done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, text + done.stdout + done.stderr)
            told = (Path(folder) / "all" / "sweep.json").read_text()
            self.assertEqual(told.count('"status": "done"'), 9)


if __name__ == "__main__":
    unittest.main()
