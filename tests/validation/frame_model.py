#!/usr/bin/env python3
"""A second opinion on trees that follow a scene which moves: refits and updates by clusters, computed here from
docs/how-it-works/frames.md and accel/builders/deal.h. Boxes have to be equal to the bit, leaves to hold the same primitives,
and the builder of the machine to have moved as many bytes as are counted here.

    frame_model.py FRAME_FACTS CAROUSEL [--rounds N]

FRAME_FACTS is the test program that prints the trees. That the comparison can fail is tried in every run.
"""
import argparse
import base64
import json
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

LINE, PAGE, NODE, BLOCK, POSITIONS, MATRIX, RECORD, NUMBER = 64, 4096, 256, 160, 36, 48, 32, 4
INFINITY = float("inf")


def model(rng, triangles, moving):
    """A mesh of small triangles of which some move, each its own way, and one that stays."""
    corner = lambda middle: [m + rng.uniform(-0.15, 0.15) for m in middle]
    flock = [corner(middle) for middle in ([rng.uniform(-2, 2) for _ in range(3)] for _ in range(triangles))
             for _ in range(3)]
    flock = [p for t in sorted(zip(*[iter(flock)] * 3)) for p in t]
    ways = []
    for t in range(triangles):
        way = [rng.uniform(-1, 1) if t < moving else 0.0 for _ in range(3)]
        ways += [way] * 3
    ground = [[-4, -3, -4], [4, -3, -4], [4, -3, 4]]
    rows = [flock, ways, ground, [[0.0], [1.0]], [[0.01], [1.0]]]  # with weights of 0 a node shows another mesh
    data, views, accessors = b"", [], []
    for rows_of in rows:
        width = len(rows_of[0])
        packed = struct.pack(f"<{width * len(rows_of)}f", *[x for row in rows_of for x in row])
        singles = list(zip(*[iter(struct.unpack(f"<{width * len(rows_of)}f", packed))] * width))
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessors.append({"bufferView": len(accessors), "componentType": 5126, "count": len(rows_of),
                          "type": {1: "SCALAR", 3: "VEC3"}[width], "min": [min(c) for c in zip(*singles)],
                          "max": [max(c) for c in zip(*singles)]})
        data += packed
    primitive = {"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"mesh": 1}],
            "meshes": [{"primitives": [primitive]}, {"primitives": [{"attributes": {"POSITION": 2}}]}],
            "animations": [{"samplers": [{"input": 3, "output": 4}],
                            "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}],
            "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}


# ---- boxes and references

EMPTY = [INFINITY] * 3 + [-INFINITY] * 3


def union(boxes):
    out = EMPTY
    for box in boxes:
        out = [min(a, b) for a, b in zip(out[:3], box[:3])] + [max(a, b) for a, b in zip(out[3:], box[3:])]
    return out


def area(box):
    x, y, z = (box[axis + 3] - box[axis] for axis in range(3))
    return x * y + y * z + z * x


is_inner = lambda ref: ref < 1 << 30
is_instance = lambda ref: ref >> 30 == 2
size = lambda leaf: (leaf >> 26 & 15) + 1
first_block = lambda leaf: leaf & 0x03ffffff


class Tree:
    """A structure as it is printed, and the corners of its triangles."""

    def __init__(self, facts):
        self.nodes = [[[ref, box] for ref, box in node["children"]] for node in facts["built"]["nodes"]]
        self.above_instances = [node["above_instances"] for node in facts["built"]["nodes"]]
        self.leaves = {int(bits): list(which) for bits, which in facts["built"]["leaves"].items()}
        self.instances, self.meshes = facts["instances"], facts["meshes"]
        self.blocks = facts["blocks"]
        for instance in self.instances:  # a mesh in one leaf hangs below no node
            if not is_inner(instance["root"]) and instance["triangles"]:
                self.leaves.setdefault(instance["root"], list(range(size(instance["root"]))))

    def box_of(self, mesh, primitive):
        corners = self.meshes[mesh]["after"][3 * primitive:3 * primitive + 3]
        return union([corner * 2 for corner in corners])

    def has_moved(self, mesh, primitive):
        part = slice(3 * primitive, 3 * primitive + 3)
        return self.meshes[mesh]["before"][part] != self.meshes[mesh]["after"][part]

    def box_below(self, mesh, ref):
        if is_inner(ref):
            return union(box for _, box in self.nodes[ref])
        return union(self.box_of(mesh, p) for p in self.leaves[ref])

    def refit(self, mesh, ref, stop=()):
        if is_inner(ref) and ref not in stop:
            for child in self.nodes[ref]:
                child[1] = self.refit(mesh, child[0], stop)
        return self.box_below(mesh, ref)

    def refit_top(self):
        for number in reversed(range(len(self.nodes))):
            for child in self.nodes[number] if self.above_instances[number] else []:
                if is_instance(child[0]):
                    instance = self.instances[child[0] & 0x3fffffff]
                    child[1] = self.box_below(instance["mesh"], instance["root"])
                else:
                    child[1] = union(box for _, box in self.nodes[child[0]])

    def primitives(self, ref):
        return sum(self.primitives(child) for child, _ in self.nodes[ref]) if is_inner(ref) else size(ref)

    def leaves_of(self, ref):
        return [leaf for child, _ in self.nodes[ref] for leaf in self.leaves_of(child)] if is_inner(ref) else [ref]

    def nodes_of(self, ref):
        return [ref] + [n for child, _ in self.nodes[ref] for n in self.nodes_of(child)] if is_inner(ref) else []


# ---- items that are dealt out

def shape_of(tree, ref, ends):
    """(children, items) of a subtree down to its leaves, or to those references of `ends`."""
    if ref in ends:
        return ([], 1)
    if not is_inner(ref):
        return ([], size(ref))
    children = [shape_of(tree, child, ends) for child, _ in tree.nodes[ref]]
    return (children, sum(child[1] for child in children))


def deal(shape, items):
    """The items in the order of the places, and how often one was added to a box."""
    children, count = shape
    return part(children, items) if children else (items, 0)


def levels_of(items):
    whole = items.bit_length() - 1
    return whole + items / (1 << whole)


def part(children, items):
    if len(children) == 1:
        return deal(children[0], items)
    best = None
    for axis in range(3):
        order = sorted(items, key=lambda item: (item[0][axis] + item[0][axis + 3], item[1]))
        cost = [0.0] * len(order)
        box = EMPTY
        for i in range(len(order) - 1, 0, -1):
            box = union([box, order[i][0]])
            cost[i] = area(box) * levels_of(len(order) - i)
        box = EMPTY
        for i in range(1, len(order)):
            box = union([box, order[i - 1][0]])
            cost[i] = area(box) * levels_of(i) + cost[i]
        for chosen in range(1, (1 << len(children)) - 1):
            first = sum(child[1] for i, child in enumerate(children) if chosen >> i & 1)
            if best is None or cost[first] < best[0]:
                best = (cost[first], chosen, first, order)
    _, chosen, first, order = best
    places, boxes = {}, 2 * len(items)
    for wanted, some in ((1, order[:first]), (0, order[first:])):
        mine = [i for i in range(len(children)) if chosen >> i & 1 == wanted]
        dealt, more = part([children[i] for i in mine], some)
        boxes += more
        for i in mine:
            places[i], dealt = dealt[:children[i][1]], dealt[children[i][1]:]
    return [item for i in range(len(children)) for item in places[i]], boxes


def dealt_area(shape, items, block):
    areas = []

    def walk(shape, items, is_root):
        at = len(areas)
        areas.append(0.0)
        children, count = shape
        box = union(item[0] for item in items[:count])
        for child in children:
            walk(child, items, False)
            items = items[child[1]:]
        if not is_root:
            areas[at] = area(box) * (1 if children else (count + block - 1) // block)

    walk(shape, items, True)
    total = 0.0
    for one in reversed(areas):
        total += one
    return total


# ---- what the builder reads and writes

class Builder:
    """Tasks with the lines that they read and write. Regions begin at borders of pages of their own."""

    def __init__(self, tree):
        self.tree, self.levels, self.first = tree, {}, {}
        self.read = self.written = self.top = self.boxes = 0
        count = 0
        for instance in tree.instances:
            if instance["triangles"] and instance["root"] not in self.first:
                self.first[instance["root"]] = count
                count += instance["triangles"]
        self.leaves_at = (len(tree.nodes) * NODE + 63) // 64 * 64

    def span(self, ref):
        if is_inner(ref):
            return ("structure", NODE * ref, NODE)
        return ("structure", self.leaves_at + BLOCK * first_block(ref), BLOCK * ((size(ref) + 3) // 4))

    def task(self, level, reads, writes, boxes, top=False):
        lines = lambda spans: len({(name, line) for name, at, bytes_ in spans if bytes_
                                   for line in range(at // LINE, (at + bytes_ - 1) // LINE + 1)})
        read, written = lines(reads) * LINE, lines(writes) * LINE
        self.levels[level] = True
        self.read += read
        self.written += written
        self.boxes += boxes
        self.top += (read + written) * top

    def positions(self, root, primitive):
        return ("positions", POSITIONS * (self.first[root] + primitive), POSITIONS)

    def refit_mesh(self, root, ref):
        if not is_inner(ref):
            positions = [self.positions(root, p) for p in self.tree.leaves[ref]]
            self.task(0, [self.span(ref)] + positions, [self.span(ref)], size(ref))
            return 0
        children = [child for child, _ in self.tree.nodes[ref]]
        level = max(self.refit_mesh(root, child) for child in children) + 1
        self.task(level, [self.span(ref)] + [self.span(child) for child in children], [self.span(ref)], len(children))
        return level

    def refit_top(self, heights):
        level_of = {}
        for number in reversed(range(len(self.tree.nodes))):
            if not self.tree.above_instances[number]:
                continue
            reads, boxes, level = [self.span(number)], len(self.tree.nodes[number]), 0
            for child, _ in self.tree.nodes[number]:
                if is_instance(child):
                    root = self.tree.instances[child & 0x3fffffff]["root"]
                    reads += [("matrices", MATRIX * (child & 0x3fffffff), MATRIX), self.span(root)]
                    boxes += 8
                    level = max(level, heights.get(root, -1) + 1)
                else:
                    reads.append(self.span(child))
                    level = max(level, level_of[child] + 1)
            level_of[number] = level
            self.task(level, reads, [self.span(number)], boxes, True)

    def use(self):
        return {"levels": len(self.levels), "boxes": self.boxes, "bytes_read": self.read, "bytes_written": self.written,
                "top_bytes": self.top}


def meshes_of(tree):
    """(mesh, root) in the order of their first instances."""
    out = {}
    for instance in tree.instances:
        if instance["triangles"]:
            out.setdefault(instance["mesh"], instance["root"])
    return list(out.items())


def changed(tree, mesh):
    return tree.meshes[mesh]["before"] != tree.meshes[mesh]["after"]


def refit(facts):
    tree = Tree(facts)
    builder, heights = Builder(tree), {}
    for mesh, root in meshes_of(tree):
        if changed(tree, mesh):
            tree.refit(mesh, root)
            heights[root] = builder.refit_mesh(root, root)
    tree.refit_top()
    builder.refit_top(heights)
    return tree, builder.use(), None


def cut(tree, root, most):
    clusters, above = [], []

    def divide(ref):
        if not is_inner(ref) or tree.primitives(ref) <= most:
            clusters.append(ref)
            return
        above.append(ref)
        for child, _ in tree.nodes[ref]:
            divide(child)

    divide(root)
    return clusters, above


def cut_of(tree, root, most, local):
    if most:
        return cut(tree, root, most)
    most = 1
    while len(cut(tree, root, most)[0]) > local and 2 * most <= local:
        most *= 2
    return cut(tree, root, most)


def clusters(facts, most, local):
    tree = Tree(facts)
    builder, heights, cuts = Builder(tree), {}, []
    number = primitives = 0
    for mesh, root in meshes_of(tree):
        parts, above = cut_of(tree, root, most, local)
        numbers = []
        for ref in parts:
            numbers.append(primitives)
            primitives += tree.primitives(ref)
        cuts.append((mesh, root, parts, above, number, numbers))
        number += len(parts)
    lists, children = {}, 0  # of the children of nodes above
    for _, _, _, above, _, _ in cuts:
        for node in above:
            lists[node] = children
            children += len(tree.nodes[node])
    records_at = (number + 511) // 512 * 64
    numbers_at = records_at + number * RECORD
    counts = {"count": number, "rebuilt": 0, "better": 0, "dealt_meshes": 0,
              "bytes": (number + 7) // 8 + number * RECORD + (primitives + children) * NUMBER}
    lists_at = numbers_at + primitives * NUMBER
    lists = {node: ("clusters", lists_at + NUMBER * at, NUMBER * len(tree.nodes[node])) for node, at in lists.items()}
    for mesh, root, parts, above, first, numbers in cuts:
        if not changed(tree, mesh):
            continue
        record = lambda c: ("clusters", records_at + (first + c) * RECORD, RECORD)
        end = (first + len(parts) + 7) // 8
        builder.task(0, [("clusters", first // 8, end - first // 8)], [], 0)
        moved, tasks, room = [], [], 0
        for c, ref in enumerate(parts):
            leaves = tree.leaves_of(ref)
            held = [p for leaf in leaves for p in tree.leaves[leaf]]
            if not any(tree.has_moved(mesh, p) for p in held):
                continue
            moved.append(c)
            shape, items = shape_of(tree, ref, ()), [(tree.box_of(mesh, p), p) for p in held]
            dealt, boxes = deal(shape, items)
            better = dealt_area(shape, dealt, 4) < dealt_area(shape, items, 4)
            if better:
                rest = [p for _, p in dealt]
                for leaf in leaves:
                    tree.leaves[leaf], rest = rest[:size(leaf)], rest[size(leaf):]
            counts["better"] += better
            tree.refit(mesh, ref)
            if len(held) > room:
                tasks.append([[], [], 0])
                room = max(local, len(held))
            room -= len(held)
            list_ = ("clusters", numbers_at + NUMBER * numbers[c], NUMBER * len(held))
            tasks[-1][0] += [list_] + [builder.span(n) for n in tree.nodes_of(ref)]
            tasks[-1][0] += [builder.positions(root, p) for p in held]
            tasks[-1][1] += [record(c)] + [list_] * better + [builder.span(s) for s in tree.nodes_of(ref) + leaves]
            tasks[-1][2] += boxes + 2 * len(held)
        counts["rebuilt"] += len(moved)
        for task in tasks:
            builder.task(1, *task)
        heights[root] = 1
        if not moved or not above:
            continue
        dealt = {}
        if len(parts) <= local:
            deal_where_many_moved(tree, builder, mesh, root, parts, above, {parts[c] for c in moved}, record, lists, dealt)
        counts["dealt_meshes"] += any(dealt.values())
        heights[root] = refit_above(builder, root, parts, {parts[c] for c in moved}, record, set(dealt))
        tree.refit(mesh, root, set(parts))
    tree.refit_top()
    builder.refit_top(heights)
    return tree, builder.use(), counts


def hung_below(tree, ref, above):
    return [r for child, _ in tree.nodes[ref] for r in hung_below(tree, child, above)] if ref in above else [ref]


def hang(tree, ref, above, order):
    for child in tree.nodes[ref]:
        if child[0] in above:
            hang(tree, child[0], above, order)
        else:
            child[0] = order.pop(0)


def deal_where_many_moved(tree, builder, mesh, ref, parts, above, moved, record, lists, dealt):
    """Below the highest nodes of which a cluster in four has moved."""
    if ref not in above:
        return
    hung = hung_below(tree, ref, set(above))
    count = sum(r in moved for r in hung)
    if count and 4 * count < len(hung):
        for child in [child for child, _ in tree.nodes[ref]]:
            deal_where_many_moved(tree, builder, mesh, child, parts, above, moved, record, lists, dealt)
    if not count or 4 * count < len(hung):
        return
    shape, items = shape_of(tree, ref, set(hung)), [(tree.box_below(mesh, r), i) for i, r in enumerate(hung)]
    order, boxes = deal(shape, items)
    dealt[ref] = dealt_area(shape, order, 1) < dealt_area(shape, items, 1)
    new = [hung[i] for _, i in order] if dealt[ref] else hung
    inside = nodes_above(tree, ref, set(above))
    nodes = [node for node in above if node in inside]
    was = {node: [child for child, _ in tree.nodes[node]] for node in nodes}
    below = {node: hung_below(tree, node, set(above)) for node in nodes}
    hang(tree, ref, set(above), list(new))
    writes = []
    for node in nodes:
        now = hung_below(tree, node, set(above))
        if [child for child, _ in tree.nodes[node]] != was[node]:
            writes.append(lists[node])
        if now != below[node] or any(r in moved for r in now):
            writes.append(builder.span(node))
    builder.task(2, [record(parts.index(r)) for r in hung if r not in moved] + [lists[node] for node in nodes], writes, boxes + 2 * len(items))


def nodes_above(tree, ref, above):
    return {ref}.union(*(nodes_above(tree, child, above) for child, _ in tree.nodes[ref])) if ref in above else set()


def refit_above(builder, ref, parts, moved, record, dealt):
    """Children that have moved are read again."""
    if ref in parts:
        return 1 if ref in moved else 0
    if ref in dealt:
        return 2
    reads, top = [], 0
    for child, _ in builder.tree.nodes[ref]:
        level = refit_above(builder, child, parts, moved, record, dealt)
        top = max(top, level)
        if level:
            reads.append(record(parts.index(child)) if child in parts else builder.span(child))
    if top == 0:
        return 0
    builder.task(top + 1, [builder.span(ref)] + reads, [builder.span(ref)], len(reads))
    return top + 1


# ---- the comparison

def differences(facts, tree):
    out = []
    for number, node in enumerate(facts["nodes"]):
        if [list(child) for child in node["children"]] != tree.nodes[number]:
            out.append(f"node {number}")
    out += [f"leaf {bits}" for bits, held in facts["leaves"].items() if tree.leaves[int(bits)] != held]
    return out


def simulated(carousel, folder, update, most, local):
    frames = {"count": 2, "step": 1, "update": update, "builder": {"local_primitives": local}}
    if update == "clusters" and most:
        frames["cluster_primitives"] = most
    done = subprocess.run(
        [carousel, "run", folder / "model.yaml", "--set", f"frames={json.dumps(frames)}", "--json", "--quiet", "--no-html",
         "--force", "--out", folder / "out"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads(done.stdout)["frames"]["rows"][1]


def compare(facts, name, told, row, folder):
    tree, use, counts = told
    wrong = differences(facts[name], tree)
    for key, value in use.items():
        if row["builder"][key] != value:
            wrong.append(f"{key}: {row['builder'][key]} instead of {value}")
    if counts is not None and row["clusters"] != counts:
        wrong.append(f"{row['clusters']} instead of {counts}")
    if wrong:
        sys.exit(f"{folder}: {name}: " + "; ".join(wrong[:5]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facts")
    parser.add_argument("carousel")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    for number in range(arguments.rounds):
        rng = random.Random(number)
        triangles = (2, 400, 60)[number % 3]
        moving = rng.choice([1, triangles // 3, triangles]) or 1
        most, local = ((0, 1024), (0, 32), (16, 1024), (4, 4), (32, 32))[number % 5]
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "model.gltf").write_text(json.dumps(model(rng, triangles, moving)))
            (folder / "model.yaml").write_text(
                "scene: {file: model.gltf, time: 0}\ncamera: {eye: [0, 2, 6], target: [0, 0, 0]}\n"
                f"image: {{width: 8, height: 6, max_depth: 1}}\nbvh: {{width: {rng.choice([2, 4, 8])}}}\n"
                "engine: {kind: cycle, what_if: false}\ntopology: {resources: 2}\n")
            done = subprocess.run([Path(arguments.facts).resolve(), "model.yaml", "1", str(most), str(local)],
                                  capture_output=True, text=True, cwd=folder)
            if done.returncode:
                sys.exit(done.stderr)
            facts = json.loads(done.stdout)
            case = f"round {number}: {moving} of {triangles} triangles, clusters {most or 'fit'} of {local}"
            for name, told in (("refit", refit(facts)), ("clusters", clusters(facts, most, local))):
                compare(facts, name, told, simulated(arguments.carousel, folder, name, most, local), case)
            worse = json.loads(json.dumps(facts["clusters"]))
            child = next(node for node in worse["nodes"] if node["children"])["children"][0]
            child[1][0] = -child[1][0] + 1
            if not differences(worse, clusters(facts, most, local)[0]):
                sys.exit("a wrong box has not been found")
            print(case)


if __name__ == "__main__":
    main()
