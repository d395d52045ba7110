"""What the pages of docs/ show, executed as a reader would: each block in turn, in one folder that has the configurations.
CAROUSEL names the program."""

import contextlib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


def text_of(page):
    return (SOURCE / "docs" / page).read_text()


def blocks(page, *languages):
    """Language and text of each fenced block in one of these languages, in the order of the page."""
    return re.findall(rf"^```({'|'.join(languages)})\n(.*?)^```$", text_of(page), re.M | re.S)


def commands(page):
    return [text for _, text in blocks(page, "sh")]


def execute(language, text, folder, environment):
    """What a block prints. A shell ends with its variables, for the next block; a status other than 0 is a failure."""
    words = ["bash", "-euo", "pipefail", "-c", text + "\nenv -0 >.environment"]
    if language == "python":
        words = [sys.executable, "-c", text]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{text}\n{done.stdout}{done.stderr}")
    if language != "python":
        environment.update(pair.split("=", 1) for pair in (folder / ".environment").read_text().split("\0") if "=" in pair)
    return done.stdout


class Reader:
    """Someone who works through a page in `folder`, with `carousel` on the PATH."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("configs", "examples"):
            (folder / name).symlink_to(SOURCE / name)
        self.put("carousel", Path(os.environ["CAROUSEL"]))
        self.environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "PYTHONPATH": str(SOURCE / "python")}
        del self.environment["CAROUSEL"]

    def put(self, name, program):
        """Makes a program, a file or the text of a script, one of the PATH."""
        (self.folder / "bin").mkdir(exist_ok=True)
        if isinstance(program, Path):
            (self.folder / "bin" / name).symlink_to(program)
        else:
            (self.folder / "bin" / name).write_text(program)
            (self.folder / "bin" / name).chmod(0o755)

    def execute(self, language, text):
        return execute(language, text, self.folder, self.environment)

    def all(self, texts):
        """What each of these commands prints."""
        return [self.execute("sh", text) for text in texts]


@contextlib.contextmanager
def reader():
    with tempfile.TemporaryDirectory(prefix="carousel_page_") as folder:
        yield Reader(Path(folder))
