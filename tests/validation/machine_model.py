#!/usr/bin/env python3
"""A second opinion on the cycle engine: a model of the whole machine, written from docs/cycle-engine-exact.md alone,
against the engine. For each of a number of seeded random machines it predicts the cycle at which every ray has been
shaded, and every step of every part; the engine must agree to the cycle.

    machine_model.py MACHINE_FACTS [--machines N] [--seed SEED] [--only INDEX] [--keep FOLDER]

The engine is run by the test program machine_facts, which also dumps what the model does not work out: which boxes and
triangles each ray meets, and which rays shading a ray causes.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
from machine.machine import Machine  # noqa: E402
from machine.space import draw  # noqa: E402


def compare(facts):
    """The first difference between the model and the engine, or nothing."""
    machine = Machine(facts)
    shaded = machine.run()
    steps = sorted(machine.trace.steps, key=lambda step: step[:2])
    for own, engine in zip(steps, map(tuple, facts["steps"])):
        if own != engine:
            return f"step: the model has {own}, the engine {engine}"
    if len(steps) != len(facts["steps"]):
        return f"the model has {len(steps)} steps, the engine {len(facts['steps'])}"
    for ray in facts["rays"]:
        own = shaded.get(tuple(ray["name"]))
        if own != ray.get("shaded"):
            return f"ray {ray['name']}: the model shades it in cycle {own}, the engine in {ray.get('shaded')}"
    return None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("machine_facts")
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--keep")
    arguments = parser.parse_args()
    indices = [arguments.only] if arguments.only is not None else range(arguments.machines)
    failed = refused = rays = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(arguments.keep or folder)
        folder.mkdir(exist_ok=True)
        files = []
        for index in indices:
            files.append(folder / f"machine{arguments.seed}_{index}.json")
            files[-1].write_text(json.dumps(draw(arguments.seed, index), indent=1))
        run = subprocess.Popen([arguments.machine_facts, *map(str, files)], stdout=subprocess.PIPE, text=True)
        for index, line in zip(indices, run.stdout):
            facts = json.loads(line)
            if "error" in facts:
                refused += 1
                print(f"machine {index} is refused: {facts['error'].strip()}")
                continue
            difference = compare(facts)
            rays += len(facts["rays"])
            if difference:
                failed += 1
                print(f"machine {index} of seed {arguments.seed}: {difference}")
    print(f"{len(files) - refused} machines, {rays} rays, {failed} disagree, {refused} refused")
    return 1 if failed or refused > len(files) // 4 or run.wait() != 0 else 0


if __name__ == "__main__":
    sys.exit(main())
