"""Several nearest hits against a second opinion: rays and triangles in exact rational numbers, all hits of a ray sorted by
distance, and the first k of them, whatever the machine, its buffer and its rounds.
"""
import base64
import csv
import fractions
import json
import os
import pathlib
import random
import struct
import subprocess
import tempfile
import unittest

TRIANGLES, RAYS, SIZE = 150, 40, 1.8


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def soup(seed):
    """Triangles that overlap each other, and rays through the middle of them: numbers of 32 bits."""
    rng = random.Random(seed)
    triangles = []
    for _ in range(TRIANGLES):
        middle = [rng.random() for _ in range(3)]
        triangles.append([[single(m + SIZE * (rng.random() - 0.5)) for m in middle] for _ in range(3)])
    rays = []
    for _ in range(RAYS):
        start = [single(rng.uniform(-2, -1)) for _ in range(3)]
        rays.append((start, [single(rng.random() - s) for s in start]))
    return triangles, rays


def gltf(triangles):
    floats = [x for triangle in triangles for corner in triangle for x in corner]
    data = struct.pack(f"<{len(floats)}f", *floats)
    corners = [corner for triangle in triangles for corner in triangle]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
                       "min": [min(c[i] for c in corners) for i in range(3)],
                       "max": [max(c[i] for c in corners) for i in range(3)]}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]})


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def exact_hits(triangles, ray):
    """(distance, number of the triangle) of all hits in order, by Cramer's rule (Moeller and Trumbore, 1997)."""
    origin, direction = ([fractions.Fraction(x) for x in part] for part in ray)
    out = []
    for number, triangle in enumerate(triangles):
        a, b, c = ([fractions.Fraction(x) for x in corner] for corner in triangle)
        one, two = ([x - y for x, y in zip(corner, a)] for corner in (b, c))
        normal = cross(direction, two)
        det = dot(one, normal)
        if det == 0:
            continue
        from_a = [x - y for x, y in zip(origin, a)]
        u, across = dot(from_a, normal) / det, cross(from_a, one)
        v, t = dot(direction, across) / det, dot(two, across) / det
        if u >= 0 and v >= 0 and u + v <= 1 and t >= 0:
            out.append((t, number))
    return sorted(out)


class Nearest(unittest.TestCase):
    def test_the_hits_are_the_first_of_all_in_exact_numbers(self):
        triangles, rays = soup(5)
        expected = [exact_hits(triangles, ray) for ray in rays]
        self.assertGreater(max(map(len, expected)), 16)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "soup.gltf").write_text(gltf(triangles))
            rows = [f"{i},camera," + ",".join(repr(x) for x in (*o, *d)) + ",0,inf" for i, (o, d) in enumerate(rays)]
            (folder / "rays.csv").write_text("\n".join(["ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax", *rows]) + "\n")
            for engine, shape in (("native", "ring"), ("cycle", "ring"), ("cycle", "independent")):
                for k, buffer, rounds in ((1, 1, "restart"), (3, 3, "restart"), (16, 4, "restart"), (16, 4, "resume"),
                                          (64, 1, "resume")):
                    with self.subTest(engine=engine, shape=shape, k=k, buffer=buffer, rounds=rounds):
                        self.compare(folder, expected, k, {
                            "scene": {"file": "soup.gltf"}, "workload": {"rays_from": "rays.csv"},
                            "engine": {"kind": engine, "threads": 1}, "topology": {"resources": 2, "shape": shape},
                            "collections": {"traversal": "ordered"},
                            "rays": {"query": {"nearest": k, "buffer": buffer, "rounds": rounds}}})

    def compare(self, folder, expected, k, config):
        (folder / "nearest.json").write_text(json.dumps(config))
        done = subprocess.run([os.environ["CAROUSEL"], "run", "nearest.json", "--hits", "--quiet", "--no-html", "--force",
                               "--out", "out"], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = [[] for _ in expected]
        lines = (folder / "out/hits.csv").read_text().splitlines()
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            if row["t"] not in ("", "inf"):
                found[int(row["ray"])].append((float(row["t"]), int(row["primitive"])))
        for mine, theirs in zip(found, expected):
            theirs = theirs[:k]
            self.assertEqual([number for _, number in mine], [number for _, number in theirs])
            for (t, _), (exact, _) in zip(mine, theirs):
                self.assertAlmostEqual(t / float(exact), 1, delta=2 ** -22)


if __name__ == "__main__":
    unittest.main()
