"""Starts the program."""

import contextlib
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from carousel.errors import CarouselError, error_of


class Report(dict):
    """report.json as a dict; `folder` holds the other files of the run, or is None."""

    folder = None
    picture_bytes = None  # image.png of a run whose files are gone


def load_report(path):
    """The report in a file or in the folder of a run."""
    path = Path(path)
    if path.is_dir():
        path = path / "report.json"
    report = Report(json.loads(path.read_text()))
    report.folder = path.parent
    return report


def run(config, out=None, **overrides):
    """Simulates a configuration, a dict or the path of a file, and returns its report.

    Overrides are sections or keys: `engine={"kind": "cycle"}`, or with dots as `**{"engine.kind": "cycle"}`. Without
    `out` the files of the run are removed; picture() still works.
    """
    with contextlib.ExitStack() as stack:
        folder = Path(out) if out is not None else Path(_temporary(stack)) / "out"
        words = ["run", _config_file(config, stack), "--quiet", "--out", str(folder), *_sets(overrides)]
        _call(words, allowed=(0,))
        report = load_report(folder)
        if out is None:
            report.folder = None
            if (folder / "image.png").exists():
                report.picture_bytes = (folder / "image.png").read_bytes()
        return report


def sweep(config, vary=None, out=None, exclude=(), scenes=(), points=None, seed=None, repeat=None, results=(),
          pareto=None, jobs=None, retry_failed=False, **overrides):
    """Runs a configuration with many values of some keys and returns the rows of sweep.json, dicts with the entries
    `keys`, `results`, `status` and `point`.

    `vary` gives each key a list of values or a text as on the command line ("log:64..4096:7"); a tuple of keys varies
    together over a list of tuples. With `out` the points are kept, and the same call goes on where it was. A point that
    failed is a row with an `error`.
    """
    with contextlib.ExitStack() as stack:
        folder = Path(out) if out is not None else Path(_temporary(stack)) / "out"
        words = ["sweep", _config_file(config, stack), "--quiet", "--out", str(folder), *_sets(overrides)]
        for keys, values in (vary or {}).items():
            words += ["--vary", _vary_text(keys, values)]
        for option, texts in (("--exclude", exclude), ("--scene", scenes), ("--result", results)):
            for text in texts:
                words += [option, str(text)]
        for option, value in (("--points", points), ("--seed", seed), ("--repeat", repeat), ("--pareto", pareto),
                              ("--jobs", jobs)):
            if value is not None:
                words += [option, str(value)]
        if retry_failed:
            words.append("--retry-failed")
        _call(words, allowed=(0, 1), needed=folder / "sweep.json")
        return json.loads((folder / "sweep.json").read_text())["points"]


def _program():
    found = os.environ.get("CAROUSEL") or shutil.which("carousel")
    if not found:
        raise CarouselError(None, "error: the program carousel is not on the PATH; the variable CAROUSEL may name it")
    return found


def _call(words, allowed, needed=None):
    done = subprocess.run([_program(), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          errors="replace", check=False)
    if done.returncode not in allowed or (needed is not None and not needed.exists()):
        raise error_of(done.returncode, done.stderr)


def _temporary(stack):
    return stack.enter_context(tempfile.TemporaryDirectory(prefix="carousel_"))


def _config_file(config, stack):
    if isinstance(config, (str, os.PathLike)):
        return os.fspath(config)
    # The program looks for scenes beside the configuration and then in the working folder, so relative paths work.
    path = Path(_temporary(stack)) / "config.json"
    path.write_text(json.dumps(config, indent=1))
    return str(path)


def _sets(overrides):
    words = []
    for key, value in overrides.items():
        if isinstance(value, dict):
            words += _sets({f"{key}.{name}": inner for name, inner in value.items()})
        else:
            words += ["--set", f"{key}={_value_text(value)}"]
    return words


def _value_text(value):
    return value if isinstance(value, str) else json.dumps(value)


def _vary_text(keys, values):
    if isinstance(values, str):
        return f"{keys}={values}"
    if isinstance(keys, tuple):
        return ",".join(keys) + "=" + ",".join("(" + ",".join(map(_value_text, row)) + ")" for row in values)
    return f"{keys}=" + ",".join(map(_value_text, values))
