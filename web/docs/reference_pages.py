"""Writes the pages of docs/reference that a program writes, and says where they are others. script/docs has the options."""
import itertools
import pathlib
import re
import tempfile

import example_files
from command_pages import command_pages
from config_pages import config_pages
from page_text import ROOT
from report_pages import report_pages


def navigation(pages):
    """The lines of web/docs/mkdocs.yml between its marks."""
    out = []
    for folder, title in (("config", "Configuration"), ("report", "Report"), ("commands", "Commands")):
        out.append(f"      - {title}:")
        out += [f"          - reference/{name}" for name in pages if name.startswith(folder + "/")]
    return "\n".join(out) + "\n"


NAV = re.compile(r"(?<=# written by script/docs --write:\n)(?:.*\n)*?(?= *# as far as here)")


def all_pages(program, root):
    """Every page of a program by its path, and what has no example."""
    missing = []
    program = str(pathlib.Path(program).resolve())
    with tempfile.TemporaryDirectory(prefix="carousel_docs_") as folder:
        example_files.write(program, folder, ROOT)
        found = {**config_pages(program, folder, missing), **report_pages(program, folder, root, missing), **command_pages(program, missing)}
    pages = {f"docs/reference/{name}": text for name, text in found.items()}
    nav = root / "web/docs/mkdocs.yml"
    pages["web/docs/mkdocs.yml"] = NAV.sub(lambda _: navigation(found), nav.read_text())
    return pages, missing


def stale(pages, root):
    """Files that a program wrote once and writes no more."""
    return [file for folder in ("config", "report", "commands") for file in sorted((root / "docs/reference" / folder).glob("*.md"))
            if str(file.relative_to(root)) not in pages]


def write(program, root):
    pages, missing = all_pages(program, root)
    for name, text in pages.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    for file in stale(pages, root):
        file.unlink()
    return missing


def first_difference(old, new):
    """The line of the page and that of the program where they part."""
    lines = itertools.zip_longest(old.split("\n"), new.split("\n"))
    at, before, now = next((at, *two) for at, two in enumerate(lines, 1) if two[0] != two[1])
    return f"line {at} is {before!r}, the program's {now!r}"


def differences(program, root):
    pages, missing = all_pages(program, root)
    for name, text in pages.items():
        old = (root / name).read_text() if (root / name).exists() else ""
        if old != text:
            missing.append(f"{name}: is not what the program writes, {first_difference(old, text)}: script/docs --write {program}")
    return missing + [f"{file.relative_to(root)}: the program does not write it: script/docs --write {program}" for file in stale(pages, root)]
