"""What the pages of docs/reference share: texts, tables and snippets of YAML."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = ("Files that examples name are written by `python3 web/docs/example_files.py CAROUSEL FOLDER`; plugins are those of "
         "`examples/`.")


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;")


def printed(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


def sections(markdown):
    """The text before the first heading of level two, and each such heading with what stands below it."""
    head, *parts = re.split(r"^## ", markdown, flags=re.M)
    return head, [part.split("\n", 1) for part in parts]


def table_rows(text):
    """The cells of the rows of tables below their heads."""
    for line in text.splitlines():
        if line.startswith("| ") and not line.startswith(("| key ", "| line ")):
            yield [one.strip() for one in re.split(r"(?<!\\)\|", line)[1:-1]]


def flow(tree):
    if isinstance(tree, str):
        return tree
    return "{" + ", ".join(f"{name}: {flow(below)}" for name, below in tree.items()) + "}"


def block(tree, indent=""):
    for name, below in tree.items():
        line = f"{indent}{name}: {flow(below)}"
        if isinstance(below, str) or len(line) <= 100:
            yield line
        else:
            yield f"{indent}{name}:"
            yield from block(below, indent + "  ")


def snippet(settings):
    """Settings as the text of a configuration."""
    tree = {}
    for setting in settings:
        key, _, value = setting.partition("=")
        at = tree
        *above, last = key.split(".")
        for name in above:
            if not isinstance(at.setdefault(name, {}), dict):
                raise ValueError(f"{setting}: a setting before it has all of {name}")
            at = at[name]
        at[last] = value
    return "\n".join(block(tree)) + "\n"
