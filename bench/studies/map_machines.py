"""The machines, scenes and rays of bench/studies/when_it_pays, and their runs."""
import dataclasses
import itertools
import json
import math
import pathlib
import sys

BUDGET = 40  # square millimetres at 45 nm
STACK, WARPS, RING = "gpu_stack.yaml", "warp_stack.yaml", "ring_distributed.yaml"
AHEAD = ["collections.partial=ahead", "testers.contexts=16", "memory.fetch_ahead=16"]
SUBTREES = ["collections.traversal=treelet", "bvh.treelet_triangles=1024", *AHEAD]
PIECES = ["collections.traversal=ordered", "collections.home=local", *AHEAD, "bvh.treelets.bytes=512"]

SPILL, DEEP = ("collections.when_full=spill",), 100_000  # from so many triangles on, and where trees stand in a tree


@dataclasses.dataclass(frozen=True)
class Kind:
    config: str
    keys: tuple  # what its machines always have
    slots: tuple  # numbers of ray slots a resource, of which it gets the best
    slots_a_warp: int = 0  # of kinds whose rays go in warps
    capacity: int = 0  # the least room for collections that it may have: without a subtree in a visit, IDs of a few blocks do
    deep: tuple = ()  # keys with larger trees than that of the search, for whose depth the room is too small

    def settings(self, slots):
        warps = [f"testers.simt.warps={slots // self.slots_a_warp}"] if self.slots_a_warp else []
        room = [f"collections.capacity={self.capacity}"] if self.capacity else []
        return [*self.keys, f"rays.slots_per_resource={slots}", *warps, *room]


KINDS = {
    "stacks": Kind(STACK, (), (8, 32)),
    "stacks in warps": Kind(WARPS, (), (32, 64), slots_a_warp=32),
    "repacked warps": Kind(WARPS, ("testers.simt.compaction=repack",), (64,), slots_a_warp=64),
    "treelet queues": Kind(RING, tuple(PIECES), (8, 16, 32), capacity=1024),
    "ring, local": Kind(RING, (*SUBTREES, "collections.home=local"), (8, 64), capacity=5120, deep=SPILL),
    "ring, travelling": Kind(RING, tuple(SUBTREES), (8, 16), capacity=5120, deep=SPILL)}
TRAVELS = "ring, travelling"
CONVENTIONAL = ("stacks", "stacks in warps", "repacked warps")
RINGS = tuple(kind for kind in KINDS if kind not in CONVENTIONAL)

CAMERA, BOUNCES, SHADOW, SHUFFLED = "camera", "bounces", "shadow", "shuffled"
# Kinds of rays: pictures, and lists of the rays of the picture with bounces: its shadow rays in their order, and its
# bounces in none.
LISTS = {SHADOW: ("shadow", False), SHUFFLED: ("bounce", True)}
RAYS_A_PIXEL = {CAMERA: 1.6, SHADOW: 0.88, BOUNCES: 2.7, SHUFFLED: 0.85}  # the least of the map's scenes
FILL = 20  # the rays of a row are at least so many times the slots of its best machines
NEAR = 0.1  # on larger pictures kinds compete that are so near to the best


@dataclasses.dataclass(frozen=True)
class Grid:
    triangles: tuple
    channels: tuple
    frames: tuple  # scenes, each with a kind of rays
    seeds: tuple
    camera: tuple  # width and height of the least pictures
    bounces: tuple
    searched: tuple  # frames with a number of triangles, on which splits are searched: on the first with all slots
    marker: str = ""  # place of its table in the page; printed without one

    def size(self, rays, slots):
        """Width and height of a picture whose rays fill so many slots."""
        width, height = self.camera if rays == CAMERA else self.bounces
        scale = max(1, math.sqrt(FILL * slots / (RAYS_A_PIXEL[rays] * width * height)))
        return tuple(8 * math.ceil(side * scale / 8) for side in (width, height))


ALL_FRAMES = tuple(itertools.product(("terrain", "spheres"), (CAMERA, SHADOW, BOUNCES, SHUFFLED)))
SIZES = (10_000, 60_000, 360_000)
SEARCHED = (("terrain", BOUNCES, 60_000),)
GRIDS = {
    "try": Grid((10_000,), (1, 16), ALL_FRAMES[:4], (1, 2), (128, 80), (96, 64),
                (("terrain", BOUNCES, 10_000), ("terrain", SHADOW, 10_000))),
    "small": Grid(SIZES, (1, 4, 16), ALL_FRAMES, (1, 2, 3, 4, 5), (176, 112), (128, 96), SEARCHED, marker="rows"),
    "million": Grid((1_000_000, 10_000_000), (1, 4), (("terrain", CAMERA), ("terrain", BOUNCES)), (1, 2), (176, 112), (128, 96),
                    SEARCHED, marker="million")}

# Machines and scenes that the map does not contain: what it says of them is compared with what they do. They were chosen
# after the rule of map_axes, before the rows with 10,000 and 360,000 triangles were run.
OTHERS = [
    ("terrain", 60_000, 4, BOUNCES, ["area.budget_mm2=25"]), ("spheres", 60_000, 1, CAMERA, ["area.budget_mm2=60"]),
    ("terrain", 10_000, 4, SHADOW, ["area.budget_mm2=60"]), ("spheres", 360_000, 2, SHADOW, []),
    ("terrain", 120_000, 2, SHADOW, []), ("terrain", 30_000, 2, CAMERA, ["memory.dram.preset=hbm2_2"]),
    ("instances", 60_000, 2, SHADOW, []), ("foliage", 20_000, 4, CAMERA, []), ("spheres", 20_000, 4, SHUFFLED, []),
    ("terrain", 60_000, 1, SHUFFLED, ["memory.dram.preset=gddr6_14"]), ("spheres", 150_000, 8, SHADOW, ["bvh.width=4"]),
    ("terrain", 60_000, 2, BOUNCES, ["image.max_depth=8"])]


def picture(width, height, scene, triangles, rays, seed):
    """The keys of a picture; a scene of a file has as many triangles as it has."""
    keys = [f"scene={{file: {scene}}}"] if is_file(scene) else [f"scene.builtin={scene}", f"scene.triangles={triangles}"]
    return [*keys, f"image.width={width}", f"image.height={height}", "image.samples=1",
            f"image.max_depth={1 if rays == CAMERA else 4}", f"image.seed={seed}"]


def is_file(scene):
    return "." in scene


def the_run(grid, kind, machine, scene, triangles, channels, rays, seed, more=(), slots=0):
    width, height = grid.size(rays, slots)
    keys = picture(width, height, scene, triangles, rays, seed)
    run = {"config": KINDS[kind].config, "triangles": triangles, "rays": width * height * (1 if rays == CAMERA else 3)}
    if rays in LISTS:
        part, shuffled = LISTS[rays]
        name = f"{pathlib.Path(scene).stem}-{triangles}-{rays}-{width}x{height}-{seed}"
        run["list"] = {"name": name, "config": "demo.yaml", "keys": keys, "kind": part, "shuffled": shuffled}
        keys = [key for key in keys if not key.startswith("image.")]
    run["keys"] = [
        *keys, "memory.dram.preset=lpddr5_6400", f"memory.dram.channels={channels}", f"area.budget_mm2={BUDGET}",
        "memory.l2_mshrs=64", "energy.profile=n45", "engine.what_if=false", "engine.threads=1", *more, *machine,
        *(KINDS[kind].deep if triangles > DEEP or scene == "instances" else ())]
    return run


def speed(kept):
    return 1000 * kept["rays"] / kept["cycles"]


def rays_per_joule(kept):
    return 1 / kept["nj_per_ray"]


AIMS = {"area": speed, "energy": rays_per_joule}  # what is equal, and what then counts


def same_answers(kept):
    if len({json.dumps(one["digest"], sort_keys=True) for one in kept}) != 1:
        sys.exit(f"machines differ in a hit: {kept[0]['run']}")
