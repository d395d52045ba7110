"""The machines, scenes and rays of bench/studies/when_it_pays, and their runs."""
import dataclasses
import itertools
import json
import pathlib
import sys

BUDGET = 40  # square millimetres at 45 nm
STACK, WARPS, RING = "gpu_stack.yaml", "warp_stack.yaml", "ring_distributed.yaml"
AHEAD = ["collections.partial=ahead", "testers.contexts=16", "memory.fetch_ahead=16"]
SUBTREES = ["collections.traversal=treelet", "collections.capacity=20480", "bvh.treelet_triangles=1024", *AHEAD]
PIECES = ["collections.traversal=ordered", "collections.home=local", *AHEAD]


def sets(key, *values):
    return [[f"{key}={value}"] for value in values]


def warps(*slots_and_warps):
    return [[f"rays.slots_per_resource={slots}", f"testers.simt.warps={number}"] for slots, number in slots_and_warps]


SLOTS = sets("rays.slots_per_resource", 16, 8, 4, 32, 64, 256)
# A kind of machine: its file, what it always has, and the settings of which it gets the best.
KINDS = {
    "stacks": (STACK, [], [SLOTS]),
    "stacks in warps": (WARPS, [], [warps((64, 2), (32, 1), (128, 4), (256, 8), (512, 16))]),
    "repacked warps": (WARPS, ["testers.simt.compaction=repack"], [warps((128, 2), (64, 1), (256, 4), (512, 8), (1024, 16))]),
    "treelet queues": (RING, [*PIECES, "bvh.treelets.bytes=512"], [SLOTS]),
    "ring, local": (RING, [*SUBTREES, "collections.home=local"], [SLOTS]),
    "ring, travelling": (RING, SUBTREES, [SLOTS])}
WARPS_KIND = "stacks in warps"
CONVENTIONAL = ("stacks", WARPS_KIND, "repacked warps")
TRAVELS = "ring, travelling"

CAMERA, BOUNCES, SHADOW, SHUFFLED = "camera", "bounces", "shadow", "shuffled"
# Kinds of rays: pictures, and lists of the rays of the picture with bounces: its shadow rays in their order, and its
# bounces in none.
LISTS = {SHADOW: ("shadow", False), SHUFFLED: ("bounce", True)}


@dataclasses.dataclass(frozen=True)
class Grid:
    triangles: tuple
    channels: tuple
    frames: tuple  # scenes, each with a kind of rays
    seeds: tuple
    camera: tuple  # width and height of the pictures
    bounces: tuple
    tunes: bool = True  # machines are tuned, or have the first of their settings
    others: bool = False  # the map is asked for machines that it does not contain
    marker: str = ""  # place of its table in the page; printed without one


ALL_FRAMES = tuple(itertools.product(("terrain", "spheres"), (CAMERA, SHADOW, BOUNCES, SHUFFLED)))
GRIDS = {
    "try": Grid((10000,), (1, 16), ALL_FRAMES[:4], (1, 2), (128, 80), (96, 64), tunes=False),
    "small": Grid((10000, 60000, 360000), (1, 4, 16), ALL_FRAMES, (1, 2, 3, 4, 5), (176, 112), (128, 96), others=True,
                  marker="rows"),
    "million": Grid((1_000_000, 10_000_000), (1, 4), tuple(itertools.product(("terrain",), (CAMERA, BOUNCES))), (1, 2), (176, 112),
                    (128, 96), tunes=False, marker="million"),
    "large": Grid((100_000, 1_000_000, 10_000_000), (1, 4, 16), ALL_FRAMES, (1, 2, 3, 4, 5), (384, 240), (256, 160), marker="rows")}
TUNED_ON = ("terrain", BOUNCES)  # with all settings; other frames from the best of these on

# Machines and scenes that the map does not contain: what it says of them is compared with what they do.
OTHERS = [
    ("spheres", 25000, 1, "bounces", []), ("terrain", 25000, 16, "camera", []), ("terrain", 200000, 1, "bounces", []),
    ("spheres", 200000, 4, "camera", []), ("terrain", 200000, 8, "bounces", []), ("instances", 60000, 8, "bounces", []),
    ("terrain", 60000, 4, "bounces", ["memory.l2_kib=128"]), ("spheres", 60000, 1, "camera", ["memory.l2_kib=2048"]),
    ("terrain", 10000, 2, "bounces", ["testers.box.units=8", "testers.triangle.units=2"]),
    ("spheres", 360000, 2, "bounces", ["memory.shape_buffer_kib=64"]),
    ("terrain", 360000, 8, "camera", ["bvh.width=4"]), ("terrain", 30000, 2, "bounces", ["area.budget_mm2=80"]),
    # The second twelve, chosen after the rule of choice and before they were run.
    ("terrain", 100000, 2, "shadow", []), ("spheres", 15000, 1, "shuffled", []), ("instances", 30000, 1, "camera", []),
    ("spheres", 100000, 2, "camera", ["testers.box.units=2"]), ("terrain", 60000, 1, "bounces", ["memory.l2_kib=1024"]),
    ("spheres", 60000, 1, "shadow", ["memory.l2_kib=256"]), ("terrain", 25000, 1, "camera", ["memory.shape_buffer_kib=16"]),
    ("spheres", 360000, 4, "shadow", ["area.budget_mm2=80"]), ("terrain", 60000, 1, "camera", ["area.budget_mm2=20"]),
    ("spheres", 25000, 1, "bounces", ["bvh.width=4"]), ("terrain", 200000, 1, "shadow", ["memory.shared_by=4"]),
    ("terrain", 60000, 2, "shuffled", ["testers.triangle.units=2"])]


def settings(kind, grid):
    """All settings of which a kind of machine gets the best."""
    _, always, choices = KINDS[kind]
    all_of_them = [[*always, *itertools.chain(*choice)] for choice in itertools.product(*choices)]
    return all_of_them if grid.tunes else all_of_them[:1]


def picture(grid, scene, triangles, rays, seed):
    """The keys of a picture; a scene of a file has as many triangles as it has."""
    width, height = grid.camera if rays == CAMERA else grid.bounces
    keys = [f"scene={{file: {scene}}}"] if is_file(scene) else [f"scene.builtin={scene}", f"scene.triangles={triangles}"]
    return [*keys, f"image.width={width}", f"image.height={height}", "image.samples=1",
            f"image.max_depth={1 if rays == CAMERA else 4}", f"image.seed={seed}"]


def is_file(scene):
    return "." in scene


def the_run(grid, kind, machine, scene, triangles, channels, rays, seed, more=()):
    keys = picture(grid, scene, triangles, rays, seed)
    width, height = grid.camera if rays == CAMERA else grid.bounces
    run = {"config": KINDS[kind][0], "triangles": triangles, "rays": width * height * (1 if rays == CAMERA else 3)}
    if rays in LISTS:
        part, shuffled = LISTS[rays]
        name = f"{pathlib.Path(scene).stem}-{triangles}-{rays}-{width}x{height}-{seed}"
        run["list"] = {"name": name, "config": "demo.yaml", "keys": keys, "kind": part, "shuffled": shuffled}
        keys = [key for key in keys if not key.startswith("image.")]
    run["keys"] = [
        *keys, "memory.dram.preset=lpddr5_6400", f"memory.dram.channels={channels}", f"area.budget_mm2={BUDGET}",
        "area.fit=all", "memory.l2_mshrs=64", "energy.profile=n45", "engine.what_if=false", "engine.threads=1", *machine,
        *more]
    return run


def speed(kept):
    return 1000 * kept["rays"] / kept["cycles"]


def rays_per_joule(kept):
    return 1 / kept["nj_per_ray"]


AIMS = {"area": speed, "energy": rays_per_joule}  # what is equal, and what then counts


def same_answers(kept):
    if len({json.dumps(one["digest"], sort_keys=True) for one in kept}) != 1:
        sys.exit(f"machines differ in a hit: {kept[0]['run']}")
