"""Executes every block of docs/guides/tutorial.md in turn, in a folder of its own, on a smaller picture.

CAROUSEL names the program. With --whole, in a clone of the sources: builds as the page says, on the page's own picture, and
says how long each block took.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


def blocks():
    return re.findall(r"```(sh|sh build|python)\n(.*?)```", (SOURCE / "docs/guides/tutorial.md").read_text(), re.S)


def execute(language, text, folder, environment):
    # A shell ends with its variables, for the next block.
    words = ["bash", "-euo", "pipefail", "-c", text + "\nenv -0 >.environment"]
    if language == "python":
        words = [sys.executable, "-c", text]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{text}\n{done.stdout}{done.stderr}")
    if language != "python":
        environment.update(pair.split("=", 1) for pair in (folder / ".environment").read_text().split("\0") if "=" in pair)
    return done.stdout


class Tutorial(unittest.TestCase):
    def test_every_block_works(self):
        found = blocks()
        self.assertEqual([language for language, _ in found].count("sh build"), 1)
        self.assertGreaterEqual(len(found), 8)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "configs").symlink_to(SOURCE / "configs")
            (folder / "bin").mkdir()
            (folder / "bin" / "carousel").symlink_to(os.environ["CAROUSEL"])
            environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "PYTHONPATH": str(SOURCE / "python")}
            del environment["CAROUSEL"]
            printed = ""
            for language, text in found:
                if language == "sh build":
                    continue
                text = text.replace("width: 96, height: 64", "width: 24, height: 16")
                text = text.replace("configs/demo.yaml", "configs/demo.yaml --set image.width=64 --set image.height=40")
                printed += execute(language, text, folder, environment)
            self.assertIn("image: {width: 24, height: 16", (folder / "machine.yaml").read_text())
        self.assertRegex(printed, r"\d+ bytes a cycle are enough")
        self.assertEqual(printed.count("6 points: 6 done, 0 failed"), 2)
        self.assertRegex(printed, "hits +the same")

    def test_its_links_lead_somewhere(self):
        page = (SOURCE / "docs" / "guides" / "tutorial.md").read_text()
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page):
            self.assertTrue((SOURCE / "docs" / "guides" / target).exists(), target)


def whole():
    environment, begin = dict(os.environ), time.monotonic()
    printed, found = "", blocks()
    for language, text in found:
        start = time.monotonic()
        printed += execute(language, text, SOURCE, environment)
        print(f"{time.monotonic() - start:7.1f} s  {text.splitlines()[0]}", flush=True)
    assert "32 bytes a cycle are enough" in printed, printed
    print(f"{len(found)} blocks in {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    whole() if sys.argv[1:] == ["--whole"] else unittest.main()
