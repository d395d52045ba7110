"""What rays ask for in 2026, as published and here: several nearest hits in rounds, and opacity micromaps.

- cloud: icosahedra around Gaussians that overlap, turned and stretched, as 3DGRT traces them (N. Moenne-Loccoz et al., 3D
  Gaussian Ray Tracing, SIGGRAPH Asia 2024). Each is hit where a ray enters it and where it leaves it.
"""
import math
import random

import study_runs
from marked_tables import ROOT, markdown, replace
from published_scenes import Model

GOLDEN = (1 + math.sqrt(5)) / 2
CORNERS = [(0, a, b * GOLDEN) for a in (-1, 1) for b in (-1, 1)]
CORNERS = [corner[turn:] + corner[:turn] for turn in range(3) for corner in CORNERS]
# Faces are the triples of corners with sides of the shortest length, 2.
FACES = [(i, j, k) for i in range(12) for j in range(i) for k in range(j)
         if all(math.dist(CORNERS[a], CORNERS[b]) < 2.1 for a, b in ((i, j), (j, k), (i, k)))]


def turned(draw):
    """Axes of a random rotation, by Gram and Schmidt."""
    a, b = ([draw.gauss(0, 1) for _ in range(3)] for _ in range(2))
    a = [x / math.hypot(*a) for x in a]
    along = sum(x * y for x, y in zip(a, b))
    b = [x - along * y for x, y in zip(b, a)]
    b = [x / math.hypot(*b) for x in b]
    return a, b, [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def cloud(gaussians, seed=1):
    model, draw, vertices, triangles = Model(), random.Random(seed), [], []
    size = 0.75 / gaussians ** (1 / 3)
    for _ in range(gaussians):
        centre = [draw.gauss(0, 0.5) for _ in range(3)]
        axes = [[size * math.exp(draw.gauss(0, 0.5)) * x for x in axis] for axis in turned(draw)]
        first = len(vertices)
        vertices += [[c + sum(part * axis[i] for part, axis in zip(corner, axes)) for i, c in enumerate(centre)]
                     for corner in CORNERS]
        triangles += [tuple(first + corner for corner in face) for face in FACES]
    model.mesh(vertices, triangles, model.material([0.8, 0.8, 0.8]))
    return model


CLOUDS = ((1000, 48, 32), (8000, 96, 64))  # Gaussians, width and height of the picture
SHAPES = {"independent": ["topology.shape=independent"], "ring": ["topology.shape=ring", "collections.traversal=ordered"]}
ROUNDS = ((16, 4), (16, 2), (64, 16))  # hits and buffer; GRTX and 3DGRT have 16 a round


def nearest(program, folder):
    for gaussians, width, height in CLOUDS:
        file = f"{folder}/cloud{gaussians}.gltf"
        cloud(gaussians).write(file)
        for shape, keys in SHAPES.items():
            for hits, buffer in ROUNDS:
                visits, cycles, rounds, found = [], [], [], []
                for seed in (1, 2):
                    reports = [study_runs.run(program, folder, ROOT / "configs/nearest.yaml", [
                        f"scene={{file: {file}}}", "camera={eye: [0, 0.4, 3], target: [0, 0, 0], field_of_view: 35}",
                        f"image.width={width}", f"image.height={height}", "image.max_depth=1", f"image.seed={seed}",
                        "engine.what_if=false", f"rays.query={{nearest: {hits}, buffer: {buffer}, rounds: {way}}}", *keys])
                        for way in ("restart", "resume")]
                    restart, resume = (report["nearest"] for report in reports)
                    assert restart["digest"] == resume["digest"], "rounds find other hits"
                    study_runs.same_answers(reports)
                    visits.append([each["visits"] / each["rays"] for each in (restart, resume)])
                    cycles.append([report["engine"]["cycles"] for report in reports])
                    rounds.append(restart["rounds"] / restart["rays"])
                    found.append(restart["hits_per_ray"])
                mean = lambda values: sum(values) / len(values)
                each = lambda pairs: ", ".join(f"{before / after:.2f}" for before, after in pairs)
                before, after = (mean(column) for column in zip(*visits))
                yield [f"{gaussians:,}", shape, hits, buffer, f"{mean(found):.1f}", f"{mean(rounds):.2f}", f"{before:.1f} → {after:.1f}",
                       each(visits), each(cycles)]


def write_nearest(program, folder, _):
    replace("published: nearest", markdown(["Gaussians", "machine", "hits", "a round", "hits found a ray", "rounds a ray, restarted",
                                            "nodes a ray, restarted → resumed", "fewer, by seed", "speed, by seed"],
                                           list(nearest(program, folder))))


FOLIAGE = ((1500, 40, 25), (6000, 80, 50))  # triangles, width and height of the picture
MAPS = {"none": ("none", 0), "two states, level 3": ("two", 3), **{f"level {level}": ("four", level) for level in range(2, 7)}}


def micromaps(program, folder):
    for triangles, width, height in FOLIAGE:
        first = None
        for name, (states, level) in MAPS.items():
            reports = [study_runs.run(program, folder, ROOT / "configs/foliage_micromaps.yaml", [
                f"scene.triangles={triangles}", f"image.width={width}", f"image.height={height}", f"image.seed={seed}",
                f"bvh.micromaps={{states: {states}, level: {level}}}", "engine.what_if=false"]) for seed in (1, 2)]
            first = first or reports
            for pair in zip(first, reports):
                study_runs.same_answers(pair)
            calls = [report["tests"].get("any_hit", {"count": 0})["count"] for report in reports]
            all_calls = [report["tests"]["any_hit"]["count"] for report in first]
            yield [f"{triangles:,}", name, ", ".join(f"{count:,}" for count in calls),
                   "" if reports is first else ", ".join(f"{round(100 * (1 - a / b))} %" for a, b in zip(calls, all_calls)),
                   ", ".join(f"{a['engine']['cycles'] / b['engine']['cycles']:.2f}" for a, b in zip(first, reports)),
                   f"{reports[0]['structure']['bytes'] / 1000:,.0f}"]


def write_micromaps(program, folder, _):
    replace("published: micromaps", markdown(["triangles", "micromaps", "any-hit calls", "skipped", "speed over none", "structure, kB"],
                                             list(micromaps(program, folder))))
