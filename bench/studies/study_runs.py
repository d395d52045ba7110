"""Runs of the program for studies of simulated machines."""
import json
import subprocess
import sys

from marked_tables import ROOT


def run(program, folder, config, sets):
    """The report of a run of a configuration; ends the study if it fails."""
    command = ["nice", "-n", "10", program, "run", config, "--json", "--quiet", "--no-html", "--force", "--out",
               f"{folder}/out"]
    for value in sets:
        command += ["--set", value]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{config} {' '.join(sets)}: {done.stderr}")
    return json.loads(done.stdout)


def same_answers(reports):
    assert len({json.dumps(report["digest"], sort_keys=True) for report in reports}) == 1, "machines differ in a hit"


def commit():
    return subprocess.check_output(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], text=True).strip()
