"""Random machines: configurations of 1 to 4 resources and some 200 rays."""
import math
import pathlib
import random

import programs

from .shaders import FACTS, KINDS

SKY_MAP = pathlib.Path(__file__).resolve().parents[3] / "configs/maps/evening.hdr"


class DrawnProgram:
    """A random program of shader workers, which leaves no register unset on any way."""

    def __init__(self, r):
        self.r, self.lines, self.set = r, [], list(FACTS)
        self.body(r.randint(1, 12), 0)
        self.lines = self.lines or ["load a, 1"]

    def register(self):
        return f"r{self.r.randint(0, 7)}"

    def body(self, count, depth):
        for _ in range(count):
            self.one(depth)

    def one(self, depth):
        r, known = self.r, list(self.set)
        kind = r.random()
        if kind < 0.1 and depth < 2:
            self.lines.append(f"loop {r.randint(1, 3)}")
            self.body(r.randint(1, 4), depth + 1)
            if r.random() < 0.5:
                self.lines.append(f"break {r.choice(known)}")
            self.body(r.randint(0, 2), depth + 1)
            self.lines.append("end")
            self.set = known
        elif kind < 0.3 and depth < 3:
            self.lines.append(f"if {r.choice(self.set)}")
            self.body(r.randint(0, 4), depth + 1)
            if r.random() < 0.5:
                self.set = list(known)
                self.lines.append("else")
                self.body(r.randint(1, 4), depth + 1)
            self.lines.append("end")
            self.set = known
        elif kind < 0.33:
            self.lines.append(f"stop {r.choice(self.set)}")
        elif kind < 0.4:
            self.lines.append(f"trace {r.choice(self.set)}")
        else:
            to = self.register()
            name = r.choice(["load", "read", "read", "texture", *programs.VALUES])
            if name in ("load", "read"):
                operands = [str(r.choice([0, 1, 2.5])) if name == "load" else r.choice(["material", "vertices"])]
            else:
                count = 1 if name == "texture" else programs.VALUES[name].__code__.co_argcount
                operands = [r.choice(self.set) for _ in range(count)]
            self.lines.append(f"{name} {to}, " + ", ".join(operands))
            if to not in self.set:
                self.set.append(to)


def draw_programs(r, config):
    shading = config["shading"]
    names = r.choice([["a"], ["a", "b"], ["a", "built_in"]])
    kinds = [kind for kind in KINDS[:-1] if r.random() < 0.3]
    shading["program"] = {"default": names[0], **{kind: r.choice(names) for kind in kinds}}
    shading["registers"] = shading["lanes"] * 64 * r.choice([1, 1, 2, 5])
    line = r.choice([16, 64])
    shading["instruction_cache"] = {"bytes": line * r.choice([0, 1, 4, 32]), "line_bytes": line,
                                    "miss_cycles": r.choice([1, 7, 40])}
    config["programs"] = {kind + "_cycles": r.choice([1, 2, 5, 12])
                          for kind in ("simple", "product", "divide", "branch", "texture", "trace")}
    config["programs"]["shaders"] = {name: {"program": DrawnProgram(r).lines} for name in names if name != "built_in"}
    for name in set(config["programs"]["shaders"]) - set(shading["program"].values()):
        del config["programs"]["shaders"][name]  # nothing may be there that nothing runs
    line = r.choice([1, 1, 2]) * config["memory"]["line_bytes"]
    ways = r.choice([1, 2, 4])
    shading["data_cache"] = {"bytes": line * ways * r.choice([0, 1, 2, 7]), "line_bytes": line, "ways": ways,
                             "latency_cycles": r.choice([1, 2, 9])}
    shading["translation"] = {"page_bytes": r.choice([0, 4096, 4096, 65536]), "entries": r.choice([1, 2, 8])}


def draw_any_hit(r, config):
    """Leaves whose any-hit calls go to shader workers."""
    config["scene"].update(builtin="foliage", triangles=r.choice([20, 60]))
    config["testers"]["any_hit"] = "shader"
    shading = config["shading"]
    shading["cycles_per_any_hit"] = r.choice([0, 3, 40])
    if "program" in shading:
        lines = [line for line in DrawnProgram(r).lines if not line.startswith("trace")]
        config["programs"]["shaders"]["calls"] = {"program": lines or ["load a, 1"]}
        shading["program"]["any_hit"] = r.choice(["calls", "calls", "built_in"])
        if shading["program"]["any_hit"] != "calls":
            del config["programs"]["shaders"]["calls"]


def draw(seed, index):
    r = random.Random(seed * 1000003 + index)
    pick = r.choice
    scene = pick([{"builtin": "cornell"}, {"builtin": "terrain", "triangles": pick([30, 100])},
                  {"builtin": "instances", "instances": pick([1, 2, 6])},
                  {"builtin": "spheres", "triangles": 40, "procedural": True}])
    side = pick([3, 4, 5, 6])
    resources = pick([1, 2, 3, 4])
    units = lambda: {"units": pick([1, 2, 3, 8]), "interval_cycles": pick([1, 1, 2, 3]), "latency_cycles": pick([1, 4, 9])}
    rays = pick([1, 2, 5, 8, 16])
    flow = pick(["credits", "credits", "bubble"])
    traversal = pick(["spread", "spread", "ordered", "treelet"])
    home = pick(["issuer", "issuer", "issuer", "hash", "local"])
    full = "spill" if home == "hash" else pick(["reserve", "spill"])
    fetch = pick(["packet", "resource", "resource"])
    local = resources == 1 or home == "local"
    config = {
        "schema_version": 1,
        "scene": scene,
        "image": {"width": side, "height": side, "samples": 1, "max_depth": pick([1, 2, 3]), "seed": r.randrange(1000)},
        "engine": {"kind": "cycle", "what_if": False},
        "bvh": {"width": pick([2, 4, 8]), "leaf_triangles": pick([1, 4, 8]),
                "treelet_triangles": pick([8, 30, 2048])},
        "topology": {"resources": resources, "shape": pick(["ring", "ring", "bidirectional", "multi_ring"]),
                     "rings": min(resources, pick([2, 3])), "visit": pick(["all", "owners"]), "flow": flow,
                     "link": {"depth": pick([2, 3, 8] if flow == "bubble" else [1, 2, 4, 16]), "latency_cycles": pick([1, 2, 4, 9]),
                              "bytes_per_cycle": pick([4, 16, 32, 64, 256])}},
        "packets": {"rays": rays, "ids_per_cycle": pick([1, 3, 16]),
                    "shapes": pick(["strip", "strip", "single"]) if traversal != "ordered" else "strip",
                    "carry": "reference" if fetch == "resource" else pick(["reference", "data"]) if local else "data"},
        "collections": {"ready": pick([1, rays, 8, 32]), "sort_ids_per_cycle": pick([0, 0, 1, 4]), "traversal": traversal,
                        "policy": pick(["nearest", "fullest", "oldest", "newest", "deepest"]),
                        "partial": pick(["idle", "ahead", "ahead", "after"]),
                        "partial_after_cycles": pick([1, 20, 300]), "select": pick(["full_first", "strict"]), "home": home, "when_full": full,
                        "capacity": pick([1, rays * 3, rays * 20, 65536] if full == "spill" else [rays * 140, rays * 400, 65536])},
        "rays": {"slots_per_resource": pick([8, 16, 64, 256]), "placement": pick(["balanced", "round_robin"]),
                 "reads_per_cycle": pick([0, 0, 1, 3])},
        "accuracy": {"transformed_ray": pick(["recompute", "store"])},
        "testers": {"box": units(), "triangle": units(), "contexts": pick([1, 2, 4])},
        "memory": {"l2_kib": pick([2, 3, 16, 1024]), "ways": pick([1, 2, 8]), "line_bytes": pick([32, 64, 256]),
                   "l2_lines_per_cycle": pick([1, 1, 2, 4]),
                   "shared_by": pick([1, 2, 4]), "l2_latency_cycles": pick([1, 2, 3, 30]),
                   "dram_latency_cycles": pick([1, 3, 200]), "dram_bytes_per_cycle": pick([1, 16, 64, 512]),
                   "fetch": fetch, "fetch_ahead": pick([0, 2, 5]), "shape_buffer_kib": pick([1, 2, 4, 256]),
                   "shape_stay": pick(["until_replaced", "until_replaced", "while_used"])},
        "shading": {"workers": pick([1, 2, 5]), "cycles_per_shade": pick([0, 1, 7, 20]),
                    "cycles_per_lookup": pick([0, 5]), "products_per_cycle": pick([0, 1, 8]), "lanes": pick([1, 1, 3, 8]),
                    "sort": pick(["none", "shader"]), "sort_rays_per_cycle": pick([1, 2, 4]),
                    "distribute": pick(["fifo_fill", "load", "round_robin"]), "effects": pick(["auto", "all"])},
    }
    if config["packets"]["shapes"] == "single":
        config["packets"]["made_per"] = pick(["parent", "child"])
        if full == "reserve":
            config["collections"]["capacity"] *= 2
    if config["packets"]["shapes"] == "strip":
        config["bvh"].update(storage=pick(["full", "quantised"]), leaves=pick(["triangles", "triangles", "strips"]))
    preset = pick(["pipe", "pipe", "gddr6_14", "hbm2_2", "lpddr5_6400"])
    config["memory"]["dram"] = {"preset": preset, "channels": pick([1, 2, 3]), "interleave_bytes": pick([32, 64, 256]),
                                "mapping": pick(["row_bank_column_group", "row_bank_group_column",
                                                 "row_column_bank_group"]),
                                "queue": pick([1, 2, 5, 32]), "period_ps": pick(["auto", 250, 1000, 1701]),
                                "refresh": pick([True, True, False]), "refresh_cycles": pick(["auto", 40])}
    config["testers"]["simd"] = {"lanes": pick([1, 1, 2, 5, 8]), "map": pick(["rays", "shapes"]),
                                 "reformat_cycles": pick([0, 1, 6])}
    memory = config["memory"]
    if r.random() < 0.5:
        line = memory["line_bytes"]
        memory.update(l2_banks=pick([1, 2, 3, 8]), l2_mshrs=pick([0, 1, 2, 7]), l2_write=pick(["through", "back", "back"]),
                      l2_sector_bytes=pick(["auto", 32 if line > 32 else "auto", line // 2 if line > 32 else "auto"]))
    if r.random() < 0.4:
        memory.update(l2_answer_bytes_per_cycle=pick([1, 16, 64]), l2_ray_ways=pick([0, *range(memory["ways"])]))
    if r.random() < 0.3:
        ways = pick([1, 2, 4])
        memory.update(l1_kib=max(1, ways * memory["line_bytes"] // 1024) * pick([1, 2, 8]), l1_ways=ways,
                      l1_lines_per_cycle=pick([1, 2]), l1_mshrs=pick([0, 1, 3]), l1_latency_cycles=pick([1, 2, 5, 20]))
    sets = memory["ways"] * memory["line_bytes"] * memory.get("l2_banks", 1)  # a cache has whole sets in each bank
    step = sets // math.gcd(sets, 1024)
    memory["l2_kib"] = -(-memory["l2_kib"] // step) * step
    if r.random() < 0.3:
        memory.update(strip_end="flag", strip_ahead=pick([0, 1, 3, 8]))
    if r.random() < 0.15:  # independent resources read few of these keys
        config["topology"]["shape"] = "independent"
        config["packets"].update(shapes="strip", carry="reference", made_per="parent")
        config["collections"].update(traversal="spread", home="issuer")
        config["memory"]["fetch"] = "resource"
    elif r.random() < 0.15:
        config["topology"]["shape"] = "bus"
    if config["topology"]["shape"] != "independent" and r.random() < 0.25:
        config["rays"]["placement"] = pick(["first_taker", "addressed"])
    memory, topology = config["memory"], config["topology"]
    if (memory["fetch"] == "resource" and topology["shape"] != "independent" and not memory.get("l1_kib") and
            config["packets"]["carry"] == "reference" and r.random() < 0.5):
        memory.update(fetch="multicast", shared_by=pick([2, 3, 4]))
    if r.random() < 0.35:
        memory.update(path_state=pick(["free", "memory"]), film=pick(["free", "memory"]))
        if config["rays"].get("placement") not in ("first_taker", "addressed"):
            memory["ray_records"] = pick(["resource", "master", "master"])
    if config["topology"]["shape"] != "independent" and traversal != "treelet" and r.random() < 0.3:
        config["rays"].update(banks=pick([1, 3, 8]), reads_per_cycle=0)
    if (resources == 1 and topology["shape"] in ("ring", "bidirectional", "multi_ring") and traversal != "treelet" and
            r.random() < 0.7):
        config["topology"]["shape"] = "central"
        if r.random() < 0.6:
            config["topology"]["form"] = "distributor"
            config["testers"]["simd"].update(lanes=1)
            config["rays"].update(banks=0, reads_per_cycle=0)
            config["testers"]["distributor"] = {
                "testers": pick([1, 2, 5]), "ids_per_cycle": pick([1, 3, 16]), "queue": pick([1, 2, 8]),
                "out_of_order": pick([0, 1, 3]), "stragglers": pick(["wait", "forward"]),
                "results_per_cycle": pick([1, 2, 8]), "results": pick([1, 2, 8])}
        else:
            config["testers"]["simd"].update(lanes=pick([2, 5, 8]), map="rays")
    if config["topology"]["shape"] != "independent" and memory["fetch"] != "multicast":
        config["testers"]["own_rays"] = pick(["before", "after"])
    if config["topology"]["shape"] != "independent":
        config["testers"]["window"] = pick([1, 2, 3, 16])
        config["packets"]["results"] = pick(["mask", "message", "implied_order",
                                             "mask" if config["collections"]["traversal"] == "ordered" else "per_shape"])
    if config["topology"]["shape"] == "independent" or config["collections"]["traversal"] != "spread":
        config["collections"]["order"] = pick(["nearest", "stored"])
    if (config["collections"]["traversal"] == "ordered" and config["packets"]["carry"] == "reference" and
            (config["topology"]["shape"] != "central" or "form" in config["topology"]) and
            config["topology"]["shape"] != "independent" and r.random() < 0.6):
        config["collections"].update(key="block", block_bytes=pick([64, 300, 512, 1024, 65536]))
        config["testers"]["simd"]["lanes"] = 1
        memory["shape_buffer_kib"] = max(memory["shape_buffer_kib"], 64)
    draw_treelets(random.Random(seed * 1000003 + index + 1), config)  # leaves the draws below as they are
    own = random.Random(seed * 1000003 + index + 2)
    if own.random() < 0.3:
        draw_programs(own, config)
    elif own.random() < 0.4:
        memory["surfaces"] = "memory"
    if scene["builtin"] == "terrain" and own.random() < 0.5:
        draw_any_hit(own, config)
    if r.random() < 0.25:
        scene["sky"] = {"file": str(SKY_MAP), "rotation": pick([0, 75])}
        memory["sky_map"] = pick(["free", "memory", "memory"])
    if r.random() < 0.3:
        config["prefetcher"] = {"lines": pick([1, 2, 4]), "streams": pick([1, 2, 8]), "reach": pick([1, 8, 64, 4096])}
    if (topology["shape"] in ("ring", "bidirectional", "multi_ring") and resources > 1 and
            memory["fetch"] != "multicast" and r.random() < 0.4):
        topology["resources"] = pick([resources, 4, 5])
        topology.update(draw_graph(r, topology["resources"], config["packets"]["results"] in ("mask", "implied_order")))
    draw_rings_of_rings(random.Random(seed * 1000003 + index + 2), config)
    draw_levels(random.Random(seed * 1000003 + index + 3), config)
    draw_stacks(random.Random(seed * 1000003 + index + 4), config)
    draw_pages(random.Random(seed * 1000003 + index + 5), config)
    return config


def draw_pages(r, config):
    """Pages of what the shared caches ask the memory for, and stacks of few registers."""
    if r.random() < 0.3:
        config["memory"]["translation"] = {"page_bytes": r.choice([4096, 4096, 65536]), "entries": r.choice([1, 2, 8])}
    if config["topology"]["shape"] == "independent":
        config["testers"]["stack_entries"] = r.choice([0, 1, 1, 2, 3])


def draw_stacks(r, config):
    """Draws some machines whose resources trace their own rays."""
    topology = config["topology"]
    if topology["shape"] == "independent" and r.random() < 0.5:
        topology.update(shape="graph", trace="stacks", nodes=[{"name": "r", "count": topology["resources"]}], links=[])
        if r.random() < 0.7:
            draw_parts(r, config)


def draw_parts(r, config):
    """Caches, memories and shading behind links: a ring of all nodes, and links across."""
    pick, topology, memory = r.choice, config["topology"], config["memory"]
    resources, nodes = topology["resources"], topology["nodes"]
    config.pop("prefetcher", None)
    if "program" in config["shading"]:  # drawn caches have no ports for what programs read
        for key in ("program", "registers", "instruction_cache"):
            config["shading"].pop(key)
        config.pop("programs")
    for key in ("path_state", "film", "ray_records", "sky_map", "l2_ray_ways"):
        memory.pop(key, None)
    nodes[0]["latency_cycles"] = pick([0, 0, 2])
    names = [f"r[{i}]" for i in range(resources)]

    def add(name, kind, count, **more):
        nodes.append({"name": name, "kind": kind, "count": count, "latency_cycles": pick([0, 0, 1, 3]), **more})
        names.extend(f"{name}[{i}]" for i in range(count))

    for i in range(pick([0, 1])):
        add("x", "router", pick([1, 2]))
    kinds = []
    if r.random() < 0.8:
        kinds.append("shapes")
        lone = memory.get("strip_end") == "flag"
        interleave = lambda: pick([{}, {"interleave_bytes": memory["line_bytes"] * pick([1, 2, 8])}])
        first = r.randint(1, resources)
        behind = r.random() < 0.7
        banks = lambda: 1 if lone or not behind else pick([1, 2, 3])
        add("a", "cache", banks(), serves=f"r[0..{first - 1}]", **interleave())
        if first < resources:
            add("b", "cache", banks(), serves=f"r[{first}..{resources - 1}]", **interleave())
        if behind:
            add("m", "memory", pick([1, 1, 2]), **interleave())
    if not kinds or r.random() < 0.6:
        add("s", "shading", 1)
        kinds += pick([["new_rays"], ["completed_rays"], ["new_rays", "completed_rays"]])
    r.shuffle(names)

    def link(**ends):
        own = {"latency_cycles": pick([1, 2, 5])} if r.random() < 0.5 else {}
        if r.random() < 0.5:
            own["bytes_per_cycle"] = pick([4, 16, 64])
        return {**ends, **own}

    topology["links"] = [link(ring=", ".join(names), both=True, carries=kinds)]
    if len(names) > 3:
        topology["links"].append(link(**{"from": names[0], "to": names[2], "both": pick([True, False]),
                                         "carries": r.sample(kinds, r.randint(1, len(kinds)))}))


def draw_rings_of_rings(r, config):
    """Makes some of the rings that are left rings of rings."""
    topology = config["topology"]
    if (topology["shape"] in ("ring", "bidirectional", "multi_ring") and topology["resources"] > 1 and
            config["memory"]["fetch"] != "multicast" and r.random() < 0.4):
        resources = r.choice([topology["resources"], 4, 5, 7])
        topology.update(shape="hierarchical", resources=resources, groups=r.randint(1, min(4, resources)))


def draw_levels(r, config):
    """Levels of accuracy, other clocks, routers with few places, and resources unlike the others, on some machines."""
    pick, accuracy, topology = r.choice, config["accuracy"], config["topology"]
    if r.random() < 0.4:
        accuracy["triangle"] = pick(["fast", "watertight", "double"])
    if config["bvh"].get("storage", "full") == "full" and r.random() < 0.4:
        accuracy["box"] = pick(["plain", "conservative", "double"])
    if config["scene"]["builtin"] == "instances" and r.random() < 0.8:
        accuracy["transform"] = pick(["two_step", "two_step_double", "inverse_matrix"])
        accuracy["instance_data"] = "forward"
    if r.random() < 0.3:
        config["engine"]["clock_mhz"] = pick([700, 1333])
    for node in topology["nodes"] if topology["shape"] == "graph" else []:
        if node.get("kind") == "router" and r.random() < 0.6:
            node["buffers"] = pick([1, 2, 4])
    if topology["shape"] in ("ring", "bidirectional", "multi_ring", "bus") and r.random() < 0.3:
        box = {"units": 1, "interval_cycles": pick([1, 3]), "latency_cycles": 7}
        topology["overrides"] = [{"resource": 0, "testers": {"box": box}}]


def draw_treelets(r, config):
    """Cuts the tree of some machines into treelets."""
    c, bvh, topology, memory = config["collections"], config["bvh"], config["topology"], config["memory"]
    if (config["packets"]["shapes"] != "strip" or topology["shape"] in ("bus", "central") or
            config["packets"].get("results", "mask") != "mask" or c.get("key") == "block" or
            config["rays"].get("banks", 0) > 0 or bvh.get("leaves") == "strips" or memory.get("strip_end") == "flag"):
        return
    if r.random() < 0.6:
        bvh["treelets"] = {"bytes": r.choice([200, 600, 1500, 65536])}
        memory["shape_buffer_kib"] = max(memory["shape_buffer_kib"], r.choice([96, 256]))
        c["order"] = r.choice(["nearest", "nearest", "stored"])
        if topology["shape"] != "independent":
            c["grouped"] = r.random() < 0.4
        if c["when_full"] == "reserve" and c["traversal"] != "ordered":
            c.pop("capacity")


def draw_graph(r, resources, widths):
    """A network that is drawn: a ring of resources and routers, and links across."""
    pick = r.choice
    routers = pick([0, 1, 2])
    nodes = [{"name": "r", "count": resources, "latency_cycles": pick([0, 0, 1, 3]), "credit_cycles": pick([0, 0, 2])}]
    if routers:
        nodes.append({"name": "x", "kind": "router", "count": routers, "latency_cycles": pick([0, 1, 2]),
                      "forward": pick(["head", "whole"]), "credit_cycles": pick([0, 1])})
    names = [f"r[{i}]" for i in range(resources)] + [f"x[{i}]" for i in range(routers)]
    r.shuffle(names)

    def own():
        link = {"latency_cycles": pick([1, 2, 5])} if r.random() < 0.5 else {}
        if r.random() < 0.3:
            link["depth"] = pick([2, 3, 6])
        if widths and r.random() < 0.4:
            link["bytes_per_cycle"] = pick([8, 16, 64])
        return link

    links = [{"ring": ", ".join(names), "both": len(names) > 2 and pick([True, False]), **own()}]
    if len(names) > 3:
        a, b = names[0], names[2]  # no neighbours on the ring
        links.append({"from": a, "to": b, "both": pick([True, False]), **own()})
    for i in range(1, pick([1, 1, 1, 2, 3])):  # lanes side by side; the link across is for all, or for the first
        if i == 1:
            for link in links[:pick([1, 2])]:
                link["lane"] = 0
        links.append({"ring": ", ".join(names if r.random() < 0.5 else names[::-1]), "lane": i, **own()})
    return {"shape": "graph", "nodes": nodes, "links": links, "tour": pick(["names", "nearest", "nearest"]),
            "visit": pick(["owners", "owners", "all"])}
