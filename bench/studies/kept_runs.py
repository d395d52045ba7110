"""Runs of the program that are kept: each leaves a file in a folder, and is not done again while it stands there. So a
study that is killed goes on where it was, in shards that may run side by side and end in time. Each file tells the commit
of its program: prices and times of others may be different."""
import collections
import csv
import hashlib
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

from marked_tables import ROOT

# A first guess of a run's time on one core, until runs have been timed: a start, a triangle of the tree, a ray.
GUESS = (1.0, 3e-6, 5e-5)
A_SEARCH = 30  # runs that area.fit: best takes

REFUSE, REDO, TAKE = "refuse", "redo", "take"  # what is done with kept runs of another commit


class OutOfTime(Exception):
    """A run would not end in the time of its shard."""


def write(file, text):
    """The file appears whole, or not at all."""
    part = file.with_suffix(f".{os.getpid()}.part")
    with open(part, "w") as out:
        out.write(text)
        out.flush()
        os.fsync(out.fileno())
    part.rename(file)


def commit_of(program):
    """As the program tells it; `-dirty` where it was built from changed files."""
    done = subprocess.run([program, "--version"], capture_output=True, text=True)
    commits = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("commit ")]
    if len(commits) != 1:
        sys.exit(f"{program} --version: expected a line with the commit, found: {done.stdout or done.stderr}")
    return commits[0]


def flat(config, prefix=""):
    """Keys with dots, and their values."""
    out = {}
    for key, value in config.items():
        out |= flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return out


class Lists:
    """Lists of rays of one kind, from a picture that the native engine traces."""

    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def file(self, name, config, keys, kind, shuffled):
        """The rays of a kind of that run, in their order or shuffled by the name."""
        file = self.folder / f"{name}.csv"
        if not file.exists():
            self.folder.mkdir(parents=True, exist_ok=True)
            rows = self.rays(config, keys)
            head = rows.pop(0)
            rays = [row for row in rows if row[1] == kind]
            if not rays:
                sys.exit(f"{name}: the picture has no rays of the kind {kind}")
            if shuffled:
                random.Random(name).shuffle(rays)
            lines = [",".join([str(number), *row[1:]]) for number, row in enumerate(rays)]
            write(file, "\n".join([",".join(head), *lines, ""]))
        return file

    def rays(self, config, keys):
        with tempfile.TemporaryDirectory() as out:
            command = [self.program, "run", ROOT / "configs" / config, "--quiet", "--no-html", "--out", f"{out}/run",
                       "--dump-rays", f"{out}/rays.csv", *(word for key in keys for word in ("--set", key))]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(f"rays of {config} {' '.join(keys)}: {done.stderr}")
            with open(f"{out}/rays.csv") as rows:
                return [row for row in csv.reader(rows) if row[0] == "ray" or row[0].isdigit()]  # not the line of the end


class Runs:
    """`shard`: number, from 0, and count. `seconds`: no run is begun that would not end within this time. `others`: what is
    done with kept runs of another commit."""

    def __init__(self, program, folder, shard=(0, 1), seconds=float("inf"), others=REFUSE):
        self.program, self.folder, self.shard, self.others = program, pathlib.Path(folder), shard, others
        self.end = time.monotonic() + seconds
        self.commit = commit_of(program)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.lists = Lists(program, self.folder / "rays" / self.commit)
        self.paces = []  # seconds over the guess, of the runs that have been timed
        found = collections.Counter()
        for file in self.folder.glob("*.json"):
            kept = json.loads(file.read_text())
            self.note(kept)
            found[kept.get("commit", "unknown")] += 1
        foreign = ", ".join(f"{number} of {commit}" for commit, number in sorted(found.items()) if commit != self.commit)
        if foreign and others == REFUSE:
            sys.exit(f"{self.folder}: keeps runs of other commits than {self.commit}: {foreign}. --others redo does them again, "
                     "--others take takes them as they are, and --out names another folder")

    def note(self, kept):
        self.paces.append(kept["seconds"] / self.guess(kept["run"], kept["rays"]))

    @staticmethod
    def guess(run, rays):
        start, each_triangle, each_ray = GUESS
        return (A_SEARCH if "area.fit=best" in run["keys"] else 1) * (start + each_triangle * run["triangles"] + each_ray * rays)

    def foretold(self, run):
        """Seconds that the run takes, by those that have been timed."""
        return self.guess(run, run["rays"]) * (statistics.median(self.paces) if self.paces else 1)

    def file(self, run):
        return self.folder / (hashlib.sha256(json.dumps(run).encode()).hexdigest()[:24] + ".json")

    def has(self, run):
        return self.file(run).exists() and (self.others != REDO or self.read(run).get("commit") == self.commit)

    def missing(self, runs):
        return [run for run in runs if not self.has(run)]

    def commits(self, runs):
        """Those of kept runs."""
        return sorted({self.read(run).get("commit", "unknown") for run in runs})

    def mine(self, runs):
        return [run for index, run in enumerate(runs) if index % self.shard[1] == self.shard[0]]

    def hours(self, runs):
        return sum(self.foretold(run) for run in self.missing(runs)) / 3600

    def do(self, runs):
        """Does what is missing of this shard's part; true if all of them are there then. Raises OutOfTime."""
        for run in self.missing(self.mine(runs)):
            if time.monotonic() + self.foretold(run) > self.end:
                raise OutOfTime
            self.one(run)
        return not self.missing(runs)

    def one(self, run):
        keys = list(run["keys"])
        if "list" in run:
            keys.append(f"workload={{rays_from: {self.lists.file(**run['list'])}}}")
        print(run["config"], *keys, file=sys.stderr, flush=True)
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as out:
            command = [self.program, "run", ROOT / "configs" / run["config"], "--charge-all", "--json", "--quiet",
                       "--no-html", "--force", "--out", f"{out}/run"]
            done = subprocess.run([*command, *(word for key in keys for word in ("--set", key))], capture_output=True,
                                  text=True)
        if done.returncode != 0:
            sys.exit(f"{run['config']} {' '.join(keys)}: {done.stderr}")
        report = json.loads(done.stdout)
        kept = {"run": run, "commit": self.commit, "seconds": time.monotonic() - began, "triangles": run["triangles"],
                "digest": report["digest"], "cycles": report["engine"]["cycles"], "rays": report["rays"]["completed"],
                "nj_per_ray": report["energy"]["nj_per_ray"], "mm2": report["area"]["mm2"],
                "resources": report["config"]["topology"]["resources"],
                "slots": report["config"]["rays"]["slots_per_resource"], "tree_bytes": report["structure"]["bytes"]}
        if "area.fit=best" in run["keys"]:
            kept["fitted"] = flat(report["config"])
        write(self.file(run), json.dumps(kept))
        self.note(kept)

    def read(self, run):
        return json.loads(self.file(run).read_text())
