#!/usr/bin/env python3
"""A second opinion on the cycle engine: a model of the whole machine, written from
docs/internals/cycle-engine-exact.md alone, against the engine. For each of a number of seeded random machines it predicts the cycle at which every ray has been
shaded, and every step of every part; the engine must agree to the cycle.

    machine_model.py MACHINE_FACTS [--machines N] [--seed SEED] [--only INDEX] [--keep FOLDER]

The engine is run by the test program machine_facts, which also dumps what the model does not work out: which boxes and
triangles each ray meets, and which rays shading a ray causes.

That the comparison can fail is tried in every run: each of LIES gives the model a part that is a little slower than the
engine's, and some machine must then disagree.

Left out, as in the page: any-hit calls, cull planes, bundles, bounding spheres, leaves held in nodes, faults,
idle_resources_shade, distribute: random, point_to_point, raster, traffic; of graphs, ways that are not the shortest,
and caches, memories and shading beside packets; warps; short stacks over drawn links. Scenes this small do not feel a TLB of several entries: the
tests DataPath.* count its misses.
"""
import argparse
import copy
import functools
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


# Keys of the configuration that the model is misled about, and by how much, or what it is told instead of a value.
LIES = {"testers.box.latency_cycles": 1, "testers.triangle.interval_cycles": 1, "packets.ids_per_cycle": 1,
        "topology.link.latency_cycles": 1, "topology.link.bytes_per_cycle": 1, "topology.link.depth": 1,
        "memory.l2_latency_cycles": 2, "memory.dram_latency_cycles": 2, "memory.dram_bytes_per_cycle": 8,
        "memory.fetch_ahead": 1, "memory.strip_ahead": 1, "memory.shape_buffer_kib": 1, "memory.dram.queue": 1, "memory.dram.channels": 1,
        "memory.l2_banks": 1, "memory.l2_answer_bytes_per_cycle": 3, "memory.l1_latency_cycles": 2, "memory.l1_mshrs": 1, "memory.l2_mshrs": 1, "memory.l2_lines_per_cycle": 1, "collections.ready": 1, "collections.sort_ids_per_cycle": 1, "collections.order": {"stored": "nearest"}, "collections.key": {"block": "node"}, "collections.grouped": {True: False}, "rays.banks": 1,
        "topology.shape": {"central": "ring"}, "topology.groups": 1, "topology.tour": {"nearest": "names"}, "topology.form": {"distributor": "cells"}, "testers.distributor.testers": 1,
        "testers.distributor.stragglers": {"forward": "wait", "wait": "forward"}, "shading.cycles_per_shade": 1,
        "programs.simple_cycles": 1, "programs.texture_cycles": 1, "programs.trace_cycles": 1, "shading.registers": -40,
        "shading.instruction_cache.miss_cycles": 1, "shading.instruction_cache.bytes": {16: 64, 64: 16},
        "shading.data_cache.latency_cycles": 1, "shading.data_cache.bytes": {64: 0, 128: 256},
        "shading.translation.page_bytes": {4096: 65536, 65536: 0},
        "memory.translation.page_bytes": {4096: 65536, 65536: 0}, "memory.translation.entries": {1: 8, 8: 1, 2: 1},
        "testers.stack_entries": {1: 2, 2: 1, 3: 0},
        "shading.cycles_per_any_hit": 1, "shading.lanes": 1, "shading.sort": {"shader": "none"}, "shading.sort_rays_per_cycle": 1,
        "memory.fetch": {"multicast": "resource"}, "memory.ray_records": {"master": "resource"},
        "memory.shape_stay": {"while_used": "until_replaced"}, "memory.path_state": {"memory": "free"}, "memory.film": {"memory": "free"},
        "memory.sky_map": {"memory": "free"}, "memory.surfaces": {"memory": "free"}, "prefetcher.lines": {1: 2, 2: 1, 4: 3}, "prefetcher.reach": -7,
        "packets.results": {"per_shape": "mask", "message": "mask", "implied_order": "mask"},
        "accuracy.transform": {"two_step_double": "two_step", "inverse_matrix": "two_step"},
        "accuracy.triangle": {"double": "fast"},
        "accuracy.box": {"double": "plain"}, "engine.clock_mhz": 333,
        "packets.made_per": {"child": "parent"}, "testers.own_rays": {"after": "before"}, "testers.window": 1}


ALL_PARTS = 40  # among so many machines that are drawn, each part that the model is misled about has to be


def notices(lie, runs):
    """Whether the comparison fails for one of `runs` when the model is misled. Those come first whose value few have: the
    others have the default, often of a part that they do not have."""
    *path, key = lie.split(".")
    section_of = lambda config: functools.reduce(lambda section, name: section[name], path, config)
    values = [section_of(facts["config"])[key] for facts in runs]
    for value, facts in sorted(zip(values, runs), key=lambda run: values.count(run[0])):
        other = LIES[lie].get(value, value) if isinstance(LIES[lie], dict) else value + LIES[lie]
        if other == value:
            continue
        config = copy.deepcopy(facts["config"])
        section_of(config)[key] = other
        try:
            if compare({**facts, "config": config}):
                return True
        except (AssertionError, KeyError, IndexError):
            return True
    return False


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("machine_facts")
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--keep")
    arguments = parser.parse_args()
    indices = [arguments.only] if arguments.only is not None else range(arguments.machines)
    failed = refused = compared = rays = 0
    agree = []
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
            compared += 1
            rays += len(facts["rays"])
            if not difference and len(agree) < 120:
                agree.append(facts)
            if difference:
                failed += 1
                print(f"machine {index} of seed {arguments.seed}: {difference}")
    answered = refused + compared
    if answered < len(files) or run.wait() != 0:
        print(f"{arguments.machine_facts} ended after {answered} of {len(files)} machines")
        return 1
    agree.sort(key=lambda facts: len(facts["steps"]))   # a lie that is noticed anywhere is noticed soonest on a short run
    for lie in LIES if len(files) >= 20 and not failed else ():
        if not notices(lie, agree):
            few = len(files) < ALL_PARTS
            failed += not few
            print(f"the comparison does not notice another {lie}" + (": these machines may lack its part" if few else ""))
    print(f"{compared} machines, {rays} rays, {failed} disagree, {refused} refused")
    return 1 if failed or refused > len(files) // 4 else 0


if __name__ == "__main__":
    sys.exit(main())
