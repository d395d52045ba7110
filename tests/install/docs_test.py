"""The documentation: script/docs finds what is planted, its pages have no fault, and those of the
reference are what the program writes. CAROUSEL names the program."""

import os
import runpy
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
CAROUSEL = str(Path(os.environ["CAROUSEL"]).resolve())
sys.path.insert(0, str(SOURCE / "web/docs"))
sys.dont_write_bytecode = True
import command_examples  # noqa: E402
import command_pages  # noqa: E402
import config_pages  # noqa: E402
import key_examples  # noqa: E402
import reference_pages  # noqa: E402
import report_examples  # noqa: E402
import report_pages  # noqa: E402

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
    def faults(self, nav=NAV, repository=True, **changed):
        with tempfile.TemporaryDirectory(prefix="carousel_docs_") as folder:
            root = Path(folder)
            shutil.copytree(SOURCE / "web/docs", root / "web/docs", ignore=shutil.ignore_patterns("__pycache__"))
            (root / "web/docs/mkdocs.yml").write_text(nav)
            (root / "docs/guides").mkdir(parents=True)
            files = {**PAGES, **{name.replace("__", "/").replace("_md", ".md"): text for name, text in changed.items()}}
            for name, text in files.items():
                (root / name).write_text(text)
            for words in (("init", "-q"), ("add", "-A"))[:2 if repository else 0]:
                subprocess.run(["git", "-C", root, *words], check=True)
            (root / "stray").mkdir()
            (root / "stray/own.md").write_text("[a](b.md)\n" if repository else "")
            done = docs("--check", "--root", root)
            self.assertEqual(done.returncode, 1 if done.stderr else 0)
            return done.stderr

    def test_good_pages_have_no_fault(self):
        self.assertEqual(self.faults(), "")

    def test_pages_without_a_repository(self):
        self.assertEqual(self.faults(repository=False), "")
        self.assertIn("a list needs an empty line",
                      self.faults(repository=False, docs__index_md=PAGES["docs/index.md"] + "Text:\n- a\n"))

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


class Reference(unittest.TestCase):
    """What has no example is named, with the table that lacks it."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="carousel_docs_")
        self.addCleanup(self.folder.cleanup)

    def test_a_key_that_needs_other_keys(self):
        schema = {"type": "integer", "minimum": 0, "maximum": 64, "default": 0}
        reached = config_pages.key_example(CAROUSEL, "memory.strip_ahead", schema, self.folder.name)
        self.assertIn("strip_ahead: 4", reached[0])
        self.assertIn("strip_end: flag", reached[0])
        with unittest.mock.patch.dict(key_examples.KEYS):
            del key_examples.KEYS["memory.strip_ahead"]
            example, why = config_pages.key_example(CAROUSEL, "memory.strip_ahead", schema, self.folder.name)
        self.assertIsNone(example)
        self.assertIn("memory.strip_ahead: the machine cannot feel this key", why)

    def test_a_key_without_a_range(self):
        example, why = config_pages.key_example(CAROUSEL, "memory.none", {"type": "string"}, self.folder.name)
        self.assertIsNone(example)
        self.assertIn("no row sets it", why)

    def test_a_number_that_no_run_has(self):
        missing = []
        one = {"few-rays": report_examples.RUNS["few-rays"]}
        with unittest.mock.patch.object(report_examples, "RUNS", one):
            pages = report_pages.report_pages(CAROUSEL, self.folder.name, SOURCE, missing)
        text = "web/docs/report_examples.py: RUNS lacks a run that has {}, or NONE a reason why no run has it"
        self.assertTrue(text.format("faults") in missing and text.format("memory.dram") in missing, missing[:5])
        self.assertFalse(any("rays.emitted" in line or "faults." in line for line in missing), missing[:5])
        self.assertRegex(pages["report/rays.md"], r"\| `rays\.lost` \| rays \|.* \| `0` \| \[few-rays\]")

    def test_an_option_without_a_line_and_a_line_that_fails(self):
        self.assertIsNone(command_pages.option_example("run", "--nothing FILE"))
        self.assertIn("--trace small", command_pages.option_example("run", "--trace FILE"))
        with unittest.mock.patch.object(command_examples, "LINES", {"check": ["carousel check small.yaml", "carousel check gone.yaml"]}):
            broken = list(command_pages.broken_commands(CAROUSEL))
        self.assertEqual(len(broken), 1)
        self.assertIn("carousel check gone.yaml: ended with status 2", broken[0])

    def test_a_line_that_serves_ends_where_interrupts_are_ignored_and_its_port_is_taken(self):
        """So it is in the background of a shell, and where two tests run at once."""
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            lines = [f"carousel serve {folder} --port {taken.getsockname()[1]}" for folder in ("small", "gone")]
            with unittest.mock.patch.object(command_examples, "LINES", {"serve": lines}):
                broken = list(command_pages.broken_commands(CAROUSEL))
        self.assertIn(len(broken), (0, 1))   # none without the module that serves
        self.assertTrue(all("serve gone" in line and "ended with status 2" in line for line in broken), broken)

    def test_numbers_by_chance(self):
        """A page keeps what this machine lacks or has by chance: a commit, a queue that was looked at, a run over ranks."""
        page = Path(self.folder.name) / f"{GONE}reference/report/a.md"
        page.parent.mkdir(parents=True)
        for key, value, here in (("carousel.commit", '"abc"', {"few-rays": {"carousel": {"commit": None}}}),
                                 ("carousel.checked", "true", {"few-rays": {"carousel": {"checked": False}}}),
                                 ("rays.a", "1", {"native": {"rays": {"a": 2}}, "ranks": None}),
                                 ("rays.a", "1", {"native": {"rays": {}}, "ranks": None})):
            with self.subTest(here):
                source = next(reversed(here))
                before = f"| `{key}` | | a | `{value}` | [{source}](index.md#{source}) |"
                page.write_text(before + "\n")
                text = f"# R\n\ntext\n\n## a\n| key | unit | meaning |\n|---|---|---|\n| `{key}` | | a |\n"
                with (unittest.mock.patch.object(report_examples, "RUNS", dict.fromkeys(here, ([], []))),
                      unittest.mock.patch.object(report_pages, "run_report", lambda _, __, name: here[name]),
                      unittest.mock.patch.object(report_pages, "printed", lambda *_: text)):
                    pages = report_pages.report_pages(CAROUSEL, self.folder.name, Path(self.folder.name), missing := [])
                self.assertIn(before.split("| a |")[1], pages["report/a.md"])
                self.assertFalse([line for line in missing if "lacks" in line or source in line])

    def test_numbers_that_vary_stay_as_they_are(self):
        self.assertEqual([report_pages.kind_of(text) for text in ("`0.25`", "`1e-05`", '`"a"`', "`true`", "3 rows")],
                         ["number", "number", "text", "truth", "rows"])

    def test_a_page_that_is_old_and_one_that_is_gone(self):
        root = Path(self.folder.name)
        for name in ("a", "b"):
            (root / "docs/reference/config").mkdir(parents=True, exist_ok=True)
            (root / f"{GONE}reference/config/{name}.md").write_text("same\nold")
        with unittest.mock.patch.object(reference_pages, "all_pages", lambda *_: ({f"{GONE}reference/config/a.md": "same\nnew"}, [])):
            found = reference_pages.differences(CAROUSEL, root)
        self.assertEqual([line.split(":")[0] for line in found], [f"{GONE}reference/config/{name}.md" for name in ("a", "b")])
        self.assertIn("line 2 is 'old', the program's 'new'", found[0])


class Charts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        sys.path.insert(0, str(SOURCE / "bench/studies"))
        cls.charts = runpy.run_path(str(SOURCE / "bench/studies/charts"))

    def test_read_the_numbers_of_cells(self):
        number = self.charts["number"]
        for cell, value in (("1,387", 1387), ("1.01 (0.95 to 1.06)", 1.01), ("-14 %", -14), ("+22 to 24 %", 23), ("139, 140", 139.5),
                            ("–, 186", 186), ("70.8 → 14.1", 70.8), ("205 (4.2)", 205), ("–, –", None), ("", None)):
            self.assertEqual(number(cell), value, cell)
        self.assertEqual(number("15,090 → 11,439", 1), 11439)

    def test_follow_their_tables(self):
        page = "# Why?\n\n| queue | rate |\n|---|---:|\n| a | 3 |\n| b | 7 (1 %) |\n| c | |\n"
        chart = {"label": ["queue"], "panels": [("rate", {"": "rate"})]}
        self.assertEqual(self.charts["data"](chart, page), [("a", [3]), ("b", [7])])

    def test_diagrams_are_those_of_their_lists(self):
        done = subprocess.run([sys.executable, SOURCE / "script/diagrams", "--check"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for page in (SOURCE / "docs/how-it-works").glob("*.md"):
            self.assertRegex(page.read_text(), r"\.svg\)", f"{page.name} has no picture")

    def test_of_all_studies_are_what_their_tables_give(self):
        done = subprocess.run([sys.executable, SOURCE / "bench/studies/charts", "--check"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Pages(unittest.TestCase):
    def test_have_no_fault_and_are_what_the_program_writes(self):
        self.assertEqual(docs("--check", CAROUSEL).stderr, "")


if __name__ == "__main__":
    unittest.main()
