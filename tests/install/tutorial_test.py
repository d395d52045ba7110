"""Executes every block of docs/guides/tutorial.md in turn, in a folder of its own, on a smaller picture.

CAROUSEL names the program. With --whole, in a clone of the sources: builds as the page says, on the page's own picture, and
says how long each block took.
"""

import os
import re
import sys
import time
import unittest
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "python"))
from page_commands import SOURCE, blocks, execute, reader, text_of

PAGE = "guides/tutorial.md"
LANGUAGES = ("sh", "sh build", "python")


class Tutorial(unittest.TestCase):
    def test_every_block_works(self):
        found = blocks(PAGE, *LANGUAGES)
        self.assertEqual([language for language, _ in found].count("sh build"), 1)
        self.assertGreaterEqual(len(found), 8)
        with reader() as user:
            printed = ""
            for language, text in found:
                if language == "sh build":
                    continue
                text = text.replace("width: 96, height: 64", "width: 24, height: 16")
                text = text.replace("configs/demo.yaml", "configs/demo.yaml --set image.width=64 --set image.height=40")
                printed += user.execute(language, text)
            self.assertIn("image: {width: 24, height: 16", (user.folder / "machine.yaml").read_text())
        self.assertRegex(printed, r"\d+ bytes a cycle are enough")
        self.assertEqual(printed.count("6 points: 6 done, 0 failed"), 2)
        self.assertRegex(printed, "hits +the same")

    def test_its_links_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text_of(PAGE)):
            self.assertTrue((SOURCE / "docs" / "guides" / target).exists(), target)


def whole():
    environment, begin = dict(os.environ), time.monotonic()
    printed, found = "", blocks(PAGE, *LANGUAGES)
    for language, text in found:
        start = time.monotonic()
        printed += execute(language, text, SOURCE, environment)
        print(f"{time.monotonic() - start:7.1f} s  {text.splitlines()[0]}", flush=True)
    assert "32 bytes a cycle are enough" in printed, printed
    print(f"{len(found)} blocks in {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    whole() if sys.argv[1:] == ["--whole"] else unittest.main()
