"""The documentation: script/docs finds what is planted, its pages have no fault, and the page of the commands is
what the program prints. CAROUSEL names the program."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
GONE = "docs/"   # apart from the names of pages that are not there: script/docs looks at this file, too
NAV = "nav:\n  - index.md\n  - glossary.md\n"
PAGES = {
    "docs/index.md": "# First\n\n## A `part`, twice\n\n## A `part`, twice\n\nSee [words](glossary.md#packet).\n",
    "docs/glossary.md": '# Words\n\n[up](index.md#a-part-twice-1)\n\n| <a id="packet"></a>packet | rays |\n',
}


def docs(*words):
    return subprocess.run([sys.executable, SOURCE / "script/docs", *map(str, words)], capture_output=True, text=True,
                          check=False)


class Check(unittest.TestCase):
    def faults(self, nav=NAV, **changed):
        with tempfile.TemporaryDirectory(prefix="carousel_docs_") as folder:
            root = Path(folder)
            shutil.copytree(SOURCE / "web/docs", root / "web/docs", ignore=shutil.ignore_patterns("__pycache__"))
            (root / "web/docs/mkdocs.yml").write_text(nav)
            (root / "docs/guides").mkdir(parents=True)
            files = {**PAGES, **{name.replace("__", "/").replace("_md", ".md"): text for name, text in changed.items()}}
            for name, text in files.items():
                (root / name).write_text(text)
            subprocess.run(["git", "-C", root, "init", "-q"], check=True)
            done = docs("--check", "--root", root)
            self.assertEqual(done.returncode, 1 if done.stderr else 0)
            return done.stderr

    def test_good_pages_have_no_fault(self):
        self.assertEqual(self.faults(), "")

    def test_a_link_to_a_file_that_is_not_there(self):
        self.assertIn(f"docs/index.md:3: other.md: there is no {GONE}other.md",
                      self.faults(docs__index_md="# First\n\nSee [other](other.md).\n\n## A part, twice\n\n## A part, twice\n"))

    def test_a_link_to_a_heading_that_is_not_there(self):
        page = PAGES["docs/index.md"].replace("#packet", "#pocket")
        self.assertIn("docs/glossary.md has no heading of this anchor", self.faults(docs__index_md=page))

    def test_links_in_code_are_none(self):
        page = PAGES["docs/index.md"] + "\n`[a](b.md)`\n\n```\n[a](b.md)\n```\n"
        self.assertEqual(self.faults(docs__index_md=page), "")

    def test_a_path_in_a_source(self):
        self.assertIn(f"own.h: there is no {GONE}gone.md", self.faults(**{"own.h": f"// {GONE}gone.md says why.\n"}))

    def test_a_page_outside_the_list_and_one_that_is_gone(self):
        self.assertIn("nav lacks glossary.md", self.faults(nav="nav:\n  - index.md\n"))
        self.assertIn(f"there is no {GONE}gone.md", self.faults(nav=NAV + "  - gone.md\n"))

    def test_a_guide_that_is_too_long(self):
        page = "docs__guides__long_md"
        nav = NAV + "  - guides/long.md\n"
        table = "| a cell | of five words |\n" * 400
        self.assertEqual(self.faults(nav=nav, **{page: f"# Long\n\n{'word ' * 1198}\n\n{table}\n```sh\n{'word ' * 400}\n```\n"}), "")
        self.assertIn(f"{GONE}guides/long.md: a guide has fewer than 1200 words of prose, not 1200",
                      self.faults(nav=nav, **{page: f"# Long\n\n{'word ' * 1199}\n"}))

    def test_a_list_without_an_empty_line_before_it(self):
        self.assertIn("a list needs an empty line", self.faults(docs__index_md=PAGES["docs/index.md"] + "Text:\n- a\n"))


class Pages(unittest.TestCase):
    def test_have_no_fault(self):
        self.assertEqual(docs("--check").stderr, "")

    def test_that_of_the_commands_is_what_they_print(self):
        page = docs("--commands", os.environ["CAROUSEL"], "--print").stdout
        self.assertTrue(page == (SOURCE / "docs/reference/commands.md").read_text(),
                        "script/docs --commands build/work/carousel")


if __name__ == "__main__":
    unittest.main()
