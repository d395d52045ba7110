#!/usr/bin/env python3
"""An optimiser chooses the points of a sweep: Optuna (Debian's python3-optuna) proposes machines, `carousel sweep --ask
--tell` runs them, and the best of them within a budget of hardware is printed.

    optimise.py [CONFIG] [--trials N] [--out FOLDER]     configs/sweep.yaml, 24 and out/optimise unless told

The points are kept in the folder: the same command again runs none of them twice.
"""

import argparse
import json
import os
import subprocess

import optuna

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("config", nargs="?", default="configs/sweep.yaml")
parser.add_argument("--trials", type=int, default=24)
parser.add_argument("--out", default="out/optimise")
arguments = parser.parse_args()

carousel = subprocess.Popen([os.environ.get("CAROUSEL", "carousel"), "sweep", arguments.config, "--out", arguments.out,
                             "--ask", "--tell", "--quiet"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def cycles(machine):
    """Runs one machine, and returns its cycles."""
    carousel.stdin.write(json.dumps(machine) + "\n")
    carousel.stdin.flush()
    row = json.loads(carousel.stdout.readline())
    if row["status"] != "done":
        raise optuna.TrialPruned(row["error"]["text"])
    return row["results"]["cycles"]


def objective(trial):
    machine = {"topology.resources": trial.suggest_int("topology.resources", 1, 8),
               "memory.l2_kib": trial.suggest_int("memory.l2_kib", 64, 1024, step=64),
               "packets.rays": trial.suggest_categorical("packets.rays", [8, 16, 32])}
    machine["collections.ready"] = machine["packets.rays"]
    # A made-up price: a resource costs as much as 128 KiB of cache.
    price = machine["topology.resources"] * 128 + machine["memory.l2_kib"]
    return cycles(machine) * (1 + max(0, price - 1024) / 1024)


optuna.logging.set_verbosity(optuna.logging.WARNING)
study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
study.optimize(objective, n_trials=arguments.trials)
carousel.stdin.close()
carousel.wait()
print(f"best of {len(study.trials)}: {json.dumps(study.best_params)}, {study.best_value:.0f} cycles with the price")
