#!/usr/bin/env python3
"""A second opinion on what the bytes of shapes say: compressed blocks of triangles and opacity micromaps, decoded here from
docs/reference/triangle-blocks.md and docs/how-it-works/fewer-tests.md alone, against the models that were put in.

    shape_model.py SHAPE_FACTS [--seed SEED] [--rounds N]

SHAPE_FACTS is the test program that prints the bytes. That the comparison can fail is tried in every run, with flipped bits
and misread states.
"""
import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))
import micromap_model  # noqa: E402
import packed_blocks  # noqa: E402
from small_gltf import Model  # noqa: E402

BITS = 12  # of scene.quantise
LEVEL = 4  # of micromaps
FLATTENED = [0.1, 0.3, 0.0]  # scales of an instance, whose triangles are on no grid of few bits


def single(x):
    return packed_blocks.struct.unpack("f", packed_blocks.struct.pack("f", x))[0]


def quantised(positions):
    """By `scene.quantise` in docs/reference/config: a grid of 2^BITS steps, each a power of two, along the longest side."""
    longest = max(max(column) - min(column) for column in zip(*positions))
    step = Fraction(2) ** (math.ceil(math.log2(longest)) - BITS)
    nearest = lambda x: math.floor(abs(x) / step + Fraction(1, 2)) * (1 if x >= 0 else -1)  # halves away from zero
    return [[float(nearest(Fraction(x)) * step) for x in position] for position in positions]


def hills(rng, columns, rows):
    """Two triangles a cell, in two parts: those of the second material are not opaque."""
    height = [[single(0.3 * math.sin(0.7 * x) * math.cos(0.5 * y) + 0.02 * rng.random()) for x in range(columns + 1)]
              for y in range(rows + 1)]
    parts = [[], []]
    for y in range(rows):
        for x in range(columns):
            corner = lambda dx, dy: [single(0.1 * (x + dx)), height[y + dy][x + dx], single(0.1 * (y + dy))]
            a, b, c, d = corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)
            parts[x // 3 % 2] += [a, b, c, d, c, b]
    return parts


def soup(rng, triangles):
    middles = [[rng.uniform(-3, 3) for _ in range(3)] for _ in range(triangles)]
    corners = [[single(x + rng.uniform(-0.4, 0.4)) for x in middle] for middle in middles for _ in range(3)]
    half = len(corners) // 6 * 3
    return [corners[:half], corners[half:]]


def blocks_model(parts):
    """A mesh of the two parts, once as it is and once flattened, and the triangles that each should have."""
    model = Model()
    solid = model.material(name="solid")
    holes = model.material(name="holes", alphaMode="MASK", pbrMetallicRoughness={"baseColorFactor": [1, 1, 1, 0.25]})
    mesh = model.mesh((solid, parts[0], None), (holes, parts[1], None))
    model.node(mesh)
    model.node(mesh, scale=FLATTENED)
    vertices = quantised(parts[0] + parts[1])
    flat = [[single(single(scale) * x) for scale, x in zip(FLATTENED, vertex)] for vertex in vertices]
    solid_triangles = len(parts[0]) // 3
    return model, [[(i | (packed_blocks.NON_OPAQUE if i >= solid_triangles else 0),
                     [tuple(corner) for corner in corners[3 * i:3 * i + 3]]) for i in range(len(corners) // 3)]
                   for corners in (vertices, flat)]


def blocks_differ(facts, expected):
    """What is wrong with the blocks, or nothing."""
    blocks = [bytes.fromhex(text) for text in facts["blocks"]]
    decoded = [packed_blocks.decoded(block) for block in blocks]
    for instance, triangles in enumerate(expected):
        found = []
        for first_block, count, first, held in facts["instances"][instance]:
            leaf = [triangle for i in range(first_block, first_block + count) for triangle in decoded[i]]
            found += leaf[first:first + held]
        if sorted(found) != triangles:
            missing = next((ours for ours, theirs in zip(triangles, sorted(found)) if ours != theirs), "some")
            return f"instance {instance} lacks {missing}"
    if len([1 for block in decoded for _ in block]) != facts["triangles"]:
        return "blocks have triangles of no leaf"
    if sum(packed_blocks.is_raw(block) for block in blocks) != facts["raw_blocks"]:
        return "the program counts other raw blocks"
    return None


def compare_blocks(facts, expected, rng):
    wrong = blocks_differ(facts, expected)
    if wrong:
        return wrong
    on_grid = [bytes.fromhex(text) for text in facts["blocks"] if not packed_blocks.is_raw(bytes.fromhex(text))]
    for _ in range(12):  # a bit that is flipped among those that every block uses, and one of the grid
        block = rng.choice(on_grid)
        broken = (int.from_bytes(block, "little") ^ 1 << rng.randrange(7, 120)).to_bytes(128, "little")
        try:
            if packed_blocks.decoded(broken) == packed_blocks.decoded(block):
                return f"a flipped bit in block {block.hex()} is not noticed"
        except (IndexError, OverflowError, ValueError):  # widths and names that no block has
            pass
    return None


def leaves_model(rng, linear, wrap, least):
    """Squares of two triangles with a picture of blots, each square with texture coordinates of its own; the last one opaque."""
    model = Model()
    width, height = rng.randrange(9, 24), rng.randrange(9, 24)
    grain, factor = rng.uniform(0.3, 0.6), 0.75
    bytes_ = [[rng.randrange(256) if rng.random() < 0.05 else 255 if math.sin(grain * x) + math.sin(grain * y + 1) > 0 else 0
               for x in range(width)] for y in range(height)]
    names = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
    filter_ = 9729 if linear else 9728
    model.texture([[(200, 200, 200, alpha) for alpha in row] for row in bytes_],
                  {"magFilter": filter_, "minFilter": filter_, "wrapS": names[wrap[0]], "wrapT": names[wrap[1]]})
    cards = model.material(alphaMode="MASK", alphaCutoff=least,
                           pbrMetallicRoughness={"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, factor]})
    solid = model.material(name="solid")
    positions, coordinates = [], []
    for card in range(12):
        at = [[card, 0, 0], [card + 0.9, 0, 0], [card + 0.9, 1, 0], [card, 1, 0]]
        size = 0.1 if card < 5 else rng.uniform(0.1, 1.2)  # small ones are often all opaque, or all transparent
        start = [rng.uniform(-1, 1.5) for _ in range(2)]
        uv = [[single(start[axis] + size * (x, y)[axis] + 0.1 * size * rng.random()) for axis in range(2)]
              for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for corner in (0, 1, 2, 0, 2, 3):
            positions.append([single(x) for x in at[corner]])
            coordinates.append(uv[corner])
    model.node(model.mesh((cards, positions, coordinates), (solid, positions[:3], coordinates[:3])))
    alpha = [[factor * value / 255 for value in row] for row in bytes_]
    texture = micromap_model.Texture(alpha, wrap, linear)
    return model, texture, [coordinates[i:i + 3] for i in range(0, len(coordinates), 3)]


def micromaps_differ(maps, laid, four):
    """What is wrong with the micromaps, or nothing."""
    counts = [0, 0, 0, 0]  # transparent, opaque, unknown, with a map
    for i, triangle in enumerate(laid):
        if wrong := micromap_model.check(maps, 0, i, triangle, four):
            return f"triangle {i}: {wrong}"
        counts[micromap_model.ALL.get(maps["entries"][i], 3)] += 1
    if maps["entries"][len(laid)] != micromap_model.NO_INDEX:
        return "the opaque triangle has an index"
    if counts != maps["triangles"]:
        return f"the program counts {maps['triangles']}, here are {counts}"
    bits = 4 ** maps["level"] * (2 if four else 1)
    if maps["bytes"] != 4 * sum(counts) + counts[3] * max(1, bits // 8):
        return f"{maps['bytes']} bytes for {counts} triangles"
    return None


def compare_micromaps(maps, laid, four):
    if wrong := micromaps_differ(maps, laid, four):
        return wrong
    known = sum(triangle.known for triangle in laid)
    # A card with an outline has unknown micro-triangles, and so no map of two states.
    if (maps["triangles"][3] > 0) != four or known < 0.8 * len(laid) * 4 ** maps["level"]:
        return f"too little is compared: {maps['triangles']} and {known} micro-triangles"
    other = {0xffffffff: 0xfffffffe, 0xfffffffe: 0xffffffff, 0xfffffffd: 0xfffffffe}
    misread = [other.get(entry, entry) for entry in maps["entries"]]
    broken = [{**maps, "entries": misread}] if misread != maps["entries"] else []
    if four:
        broken.append({**maps, "states": [byte ^ (~byte >> 1 & 0x55) for byte in maps["states"]]})
        late = zip([0] + maps["states"], maps["states"])  # each state at the place of the one before
        broken.append({**maps, "states": [(byte << 2 | before >> 6) & 255 for before, byte in late]})
    for i, wrong in enumerate(broken):
        if not micromaps_differ(wrong, laid, four):
            return f"misread states are not noticed ({i})"
    return None


def scenes(rng):
    """Name, model, keys of the configuration, and what compares the facts with the model."""
    for name, parts, leaf in (("hills", hills(rng, 40, 30), 16), ("soup", soup(rng, 700), 4)):
        model, expected = blocks_model(parts)
        yield (name, model, {"quantise": BITS}, {"leaves": "blocks", "storage": "quantised_12", "leaf_triangles": leaf},
               lambda facts, expected=expected: compare_blocks(facts["packed"], expected, rng))
    for name, linear, wrap, least in (("nearest", False, ("repeat", "mirror"), 0.5),
                                      ("filtered", True, ("clamp", "repeat"), 0.3)):
        model, texture, triangles = leaves_model(rng, linear, wrap, least)
        laid = [micromap_model.Laid(LEVEL, corners, texture, least, rng) for corners in triangles]
        for states in ("two", "four"):
            yield (f"{name}_{states}", model, {}, {"micromaps": {"states": states, "level": LEVEL}},
                   lambda facts, laid=laid, four=states == "four": compare_micromaps(facts["micromaps"], laid, four))


def compare(shape_facts, rng, folder):
    """How many scenes there are, and how many of them differ."""
    cases = list(scenes(rng))
    for name, model, scene, bvh, _ in cases:
        model.write(folder / f"{name}.gltf")
        (folder / f"{name}.json").write_text(json.dumps({"engine": {"kind": "cycle"}, "bvh": bvh,
                                                          "scene": {"file": str(folder / f"{name}.gltf"), **scene}}))
    run = subprocess.run([shape_facts, *(str(folder / f"{name}.json") for name, *_ in cases)], capture_output=True, text=True)
    lines = run.stdout.splitlines()
    if run.returncode != 0 or len(lines) != len(cases):
        print(f"{shape_facts} ended after {len(lines)} of {len(cases)} scenes: {run.stderr[-500:]}")
        return len(cases), len(cases)
    failed = 0
    for (name, _, _, _, check), line in zip(cases, lines):
        facts = json.loads(line)
        if wrong := facts["error"] if "error" in facts else check(facts):
            failed += 1
            print(f"{name}: {wrong}")
    return len(cases), failed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("shape_facts")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        compared, failed = map(sum, zip(*(compare(arguments.shape_facts, rng, Path(folder)) for _ in range(arguments.rounds))))
    print(f"{compared} scenes, {failed} differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
