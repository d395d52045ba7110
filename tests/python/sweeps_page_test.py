"""Executes every command and every Python block of docs/guides/sweeps.md, in a folder of its own. CAROUSEL names
the program."""

import json
import unittest

from page_commands import blocks, reader


SWEEP, SMALL = "carousel sweep configs/sweep.yaml", "--set image.width=16 --set image.height=12"


class SweepsPage(unittest.TestCase):
    def test_every_block_works(self):
        # Six of the shell, and one of Python.
        found = blocks("guides/sweeps.md", "sh", "python")
        self.assertEqual(len(found), 7)
        with reader() as user:
            for language, text in found:
                # A smaller picture, but where the page says how large it is.
                small = text if "image.width" in text else text.replace(SWEEP, f"{SWEEP} {SMALL}")
                user.execute(language, small)
            told = {name: json.loads((user.folder / name / "sweep.json").read_text()) for name in ("all", "tenth")}
        self.assertEqual([point["status"] for point in told["all"]["points"]], ["done"] * 9)
        # Points of the page's sampled sweep are estimates.
        self.assertEqual({point["keys"]["sampling.fraction"] for point in told["tenth"]["points"]}, {0.2})


if __name__ == "__main__":
    unittest.main()
