"""docs/reference/report: a page for each section of the report, each number with its value in a small run."""
import concurrent.futures
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess

import report_examples
from page_text import FILES, cell, printed, sections, snippet, table_rows


def found_at(report, key):
    """The values of a report at a path such as `resources[].units.box.busy`."""
    at = [report]
    for name in key.split("."):
        rows = name.endswith("[]")
        at = [one[name[:-2] if rows else name] for one in at if isinstance(one, dict) and one.get(name[:-2] if rows else name) is not None]
        if rows:
            at = [row for one in at if isinstance(one, list) for row in one]
    return [one for one in at if one is not None]


def run_command(name):
    words = f"carousel run {name}.yaml {' '.join(report_examples.RUNS[name][1])}".strip()
    ranks = report_examples.PROCESSES.get(name)
    return f"mpirun -n {ranks} {words}" if ranks else words


def run_report(program, folder, name):
    settings, options = report_examples.RUNS[name]
    (pathlib.Path(folder) / f"{name}.yaml").write_text(snippet(settings))
    words = [program, "run", f"{name}.yaml", *options, "--quiet", "--no-html", "--force", "--out", f"reports/{name}"]
    if name in report_examples.PROCESSES:
        if shutil.which("mpirun") is None:
            return None
        words = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(report_examples.PROCESSES[name]), *words]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    if done.returncode != 0 and name in report_examples.PROCESSES:
        return None   # no MPI in the program, or one that starts nothing here; the tests of ranks tell
    if done.returncode != 0:
        raise SystemExit(f"web/docs/report_examples.py: the run {name} ended with status {done.returncode}:\n{done.stderr}")
    return json.loads((pathlib.Path(folder) / f"reports/{name}/report.json").read_text())


def shown(value):
    """A value as a cell. Long ones are cut."""
    if isinstance(value, dict):
        return "keys below" if value else "`{}`"
    if isinstance(value, list):
        text = json.dumps(value)
        return f"`{text}`" if len(text) <= 40 else f"{len(value)} row{'s'[:len(value) != 1]}" if isinstance(value[0], dict) else f"`{text[:36]}`…"
    if isinstance(value, float):
        return f"`{value:.6g}`"
    if isinstance(value, str):
        value = re.sub(r"^/.*/", "/…/", value)   # where a file lies says nothing
        text = value.replace("\n", " ").replace("`", "'")
        return f"`{json.dumps(text if len(text) <= 60 else text[:57] + '...', ensure_ascii=False)}`"
    return f"`{json.dumps(value)}`"


def kind_of(text):
    """What a cell holds: values that vary are compared by this."""
    text = text.strip("`")
    return "number" if re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?", text) else "text" if text.startswith('"') else "rows" if text.endswith(
        (" row", " rows")) or text.startswith("[") else "truth" if text in ("true", "false") else text if text == "keys below" else "other"


def kept_examples(root):
    """The examples of the pages that are there: key to cell and run."""
    found = {}
    for page in sorted((root / "docs/reference/report").glob("*.md")):
        for row in table_rows(page.read_text()):
            if len(row) == 5:
                found[row[0]] = row[3:]
    return found


def report_pages(program, folder, root, missing):
    head, parts = sections(printed(program, "schema", "report", "--markdown"))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        reports = dict(zip(report_examples.RUNS, pool.map(functools.partial(run_report, program, folder), report_examples.RUNS)))
    kept, used, absent = kept_examples(root), set(), []

    def example(key):
        if key.startswith(tuple(report_examples.NONE)):
            return ["none", next(why for name, why in report_examples.NONE.items() if key.startswith(name))]
        before = kept.get(f"`{key}`")
        source = before[1][1:].partition("]")[0] if before else ""   # the run whose number the page has
        name, values = next(((name, now) for name, report in reports.items() if (now := found_at(report, key))), (None, []))
        now = [cell(shown(next((one for one in values if one not in ([], {}, "")), values[0]))), f"[{name}](index.md#{name})"] if name else None
        varies = any(key == one or key.startswith((one + ".", one + "[")) for one in report_examples.VARY)
        chance = source in report_examples.VARYING_RUNS and name in (None, *report_examples.VARYING_RUNS)
        if source in reports and (chance or varies and name in (None, source)) and (
                name != source or kind_of(before[0]) == kind_of(now[0])):   # of another name: this time that run has none, or does not run here
            used.add(source)
            return before
        if now:
            used.add(name)
            return now
        if not any(key.startswith((one + ".", one + "[")) for one in absent):
            absent.append(key)
            missing.append(f"web/docs/report_examples.py: RUNS lacks a run that has {key}, or NONE a reason why no run has it")
        return ["", ""]

    title, _, rest = head.partition("\n\n")
    rest = rest.replace("`carousel schema report --markdown`", "`script/docs --write`, from what `carousel schema report --markdown` prints")
    pages, index, terminal = {}, [title, "", rest.strip()], ["# The tables on the terminal"]
    listed = ["", "## The sections", "", "[The tables on the terminal](terminal.md), and of `report.json`:", "", "| section | keys | what it has |", "|---|---|---|"]
    names = {name for name, _ in parts}
    for name, text in parts:
        if " " in name:
            if name.startswith("The table"):
                key = re.compile(r"\| `((\w+)[\w.\[\]]*)` \| ")
                linked = key.sub(lambda m: f"| [`{m[1]}`]({m[2]}.md) | " if m[2] in names else m[0], text.rstrip())
                terminal += ["", f"## {name}", linked]
            else:
                first = re.compile(r"^\| .*? \|", re.M)
                link = lambda m: f"[{m[0]}]({m[1]}.md)" if m[1] in names else m[0]
                index += ["", f"## {name}", first.sub(lambda m: re.sub(r"`(\w+)[\w.\[\]]*`", link, m[0]), text.rstrip())]
            continue
        rows = list(table_rows(text))
        page = [f"# {name}", "", "Each example is from the run beside it; [the runs](index.md#the-runs).", "",
                "| key | unit | meaning | example | run |", "|---|---|---|---|---|"]
        page += [f"| {key} | {unit} | {meaning} | " + " | ".join(example(key.strip("`"))) + " |" for key, unit, meaning in rows]
        pages[f"report/{name}.md"] = "\n".join(page) + "\n"
        listed.append(f"| [`{name}`]({name}.md) | {len(rows)} | {rows[0][2]} |")
    for name in report_examples.RUNS:
        if name not in used:
            missing.append(f"web/docs/report_examples.py: RUNS has {name}, which no number needs: remove it")
    index += listed + ["", "## The runs", "", f"Each is the first of them that has the numbers it is named at. Numbers of `host`, of the "
                       f"native engine and of several processes vary. {FILES}"]
    for name, (settings, _) in report_examples.RUNS.items():
        index += ["", f"### {name}", "", "```yaml", snippet(settings).rstrip(), "```", "", f"    {run_command(name)}"]
    return {"report/index.md": "\n".join(index) + "\n", "report/terminal.md": "\n".join(terminal) + "\n", **pages}
