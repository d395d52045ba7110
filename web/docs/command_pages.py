"""docs/reference/commands: a page for each command, each option with a line that runs."""
import os
import pathlib
import re
import socket
import subprocess
import tempfile

import command_examples
import example_files
from page_text import FILES, ROOT, cell, printed


def help_rows(text, section):
    """The entries of a section of the help: their names and meanings."""
    found, inside = [], False
    for line in text.splitlines():
        if not line.startswith(" "):
            inside = line.rstrip() == f"{section}:"
        elif inside and re.match(r"  \S", line):
            name, gap, meaning = re.sub(r"^  ", "", line).partition("  ")
            full = re.match(r"(.{27}) (?!Needs:|Excludes:)([A-Z].*)$", name)  # a name that fills its column
            if not gap and full:
                name, meaning = full.groups()
            found.append([name.strip(), meaning.strip()])
        elif inside and found:
            found[-1][1] = f"{found[-1][1]} {line.strip()}".strip()
    return found


def option_example(command, word):
    """The first line of the command that has the option, or its first line for what is no option."""
    lines = command_examples.LINES.get(command, [])
    option = word.split()[0].split("{")[0]
    return next((line for line in lines if not option.startswith("-") or re.search(rf"{re.escape(option)}(?![\w-])", line)), None)


def command_pages(program, missing):
    names = help_rows(printed(program, "--help"), "Subcommands")
    index = ["# Commands", "", "Written by `script/docs --write` from what `carousel COMMAND --help` prints. `carousel man` is the same as a manual page. "
             f"Every example runs in a moment, in the order of a page, in a folder with small files. {FILES}", "", "| command | what it does |", "|---|---|"]
    index += [f"| [`{name}`]({name}.md) | {cell(meaning)} |" for name, meaning in names]
    pages = {}
    for name, _ in names:
        text = printed(program, name, "--help")
        lines = text.splitlines()
        usage = next(line for line in lines if line.startswith("Usage: ")).removeprefix("Usage: ")
        page = [f"# carousel {name}", "", f"{lines[0].rstrip('.')}.", "", f"    {usage}"]
        entries = help_rows(text, "Positionals") + [row for row in help_rows(text, "Options") if not row[0].startswith("-h,")]
        if entries:
            page += ["", "| word | meaning | example |", "|---|---|---|"]
        for word, meaning in entries:
            line = option_example(name, word)
            if line is None:
                missing.append(f"web/docs/command_examples.py: LINES lacks a line of {name} with {word.split()[0]}")
            kind = re.sub(r"(UINT|INT|FLOAT|NUMBER):(?:UINT|INT|FLOAT|NUMBER)? ?(in|:)", r"\1 \2", word)
            number = command_examples.LINES[name].index(line) + 1 if line else 0
            page.append(f"| `{kind}` | {cell(meaning)} | [{number}](#examples) |")
        page += ["", "## Examples", ""] + [f"{i}. `{line}`" for i, line in enumerate(command_examples.LINES.get(name, []), 1)]
        larger = help_rows(text, "Examples")
        if larger:
            page += ["", "Larger ones:", "", "```"] + [f"{line}   # {meaning}" if meaning else line for line, meaning in larger] + ["```"]
        pages[f"commands/{name}.md"] = "\n".join(page) + "\n"
    return {"commands/index.md": "\n".join(index) + "\n", **pages}


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def ended(command, line, folder, environment):
    """The status and the errors of a line. One that serves is told to end when it listens, which is its first line; not by
    an interrupt, which programs ignore that a shell started in the background. Its port is free, as tests run at once."""
    serves = command == "serve"
    if serves:
        line = "exec " + re.sub(r"(?<=--port )\d+", lambda _: str(free_port()), line)
    with subprocess.Popen(["bash", "-c", line], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE if serves else subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as started:
        if serves and started.stdout.readline().startswith("site "):
            started.terminate()
        errors = started.communicate()[1].strip()
    return (0, "") if serves and "libcpp-httplib-dev" in errors else (started.returncode, errors)   # built without the module


def broken_commands(program):
    """What is wrong with the lines of command_examples.py, each run as it stands there."""
    with tempfile.TemporaryDirectory(prefix="carousel_docs_") as folder:
        example_files.write(program, folder, ROOT)
        bin_folder = pathlib.Path(folder) / "bin"
        bin_folder.mkdir()
        (bin_folder / "carousel").symlink_to(pathlib.Path(program).resolve())
        environment = {**os.environ, "PATH": f"{bin_folder}:{os.environ['PATH']}"}
        for command, lines in command_examples.LINES.items():
            for line in lines:
                status, errors = ended(command, line, folder, environment)
                if status != 0:
                    yield f"web/docs/command_examples.py: {line}: ended with status {status}: {errors}"
