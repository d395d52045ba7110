"""Scenes like those of published measurements, made from a seed and written as glTF files with their data inside.

- weekend: the cover of Shirley, "Ray Tracing in One Weekend": some 480 spheres, each an instance, on a ground sphere. The
  rules are the book's; the random numbers are not.
- bunny: a closed, bumpy body with a head and ears of 69,000 triangles, as many as the Stanford bunny has, in a Cornell box.
- reflections: spheres and boxes of metal and glass in the same box.
- bunny_unlit, reflections_unlit: the same without the lamp, under a sky, so that there are no shadow rays.

The Cornell box has the measures of the original (555 units), open to the camera, with a lamp below its ceiling.
"""
import array
import base64
import json
import math
import random

WEEKEND = {"eye": [13, 2, 3], "target": [0, 0, 0], "field_of_view": 20, "aperture": 0.1, "focus_distance": 10}
CORNELL = {"eye": [278, 278, 800], "target": [278, 278, 0], "field_of_view": 40}


class Model:
    """A glTF document under construction; each mesh stands in the world as it is."""

    def __init__(self):
        self.data = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "materials": []}
        self.json |= {"meshes": [], "accessors": [], "bufferViews": [], "extensionsUsed": []}

    def material(self, color, metallic=0.0, roughness=1.0, glass=False, light=0.0):
        made = {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic,
                                         "roughnessFactor": roughness}}
        if glass:
            made["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1},
                                  "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_volume": {"thicknessFactor": 1}}
        if light:
            made |= {"emissiveFactor": [1, 1, 1],
                     "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": light}}}
        for name in made.get("extensions", {}):
            if name not in self.json["extensionsUsed"]:
                self.json["extensionsUsed"].append(name)
        self.json["materials"].append(made)
        return len(self.json["materials"]) - 1

    def node(self, node):
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]))
        self.json["nodes"].append(node)

    def sphere(self, centre, radius, material):
        self.node({"translation": centre, "extras": {"carousel_sphere": {"radius": radius, "material": material}}})

    def accessor(self, values, width, kind, component, code):
        values = array.array(code, values)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": 4 * len(values)})
        self.data += values.tobytes()
        made = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component, "type": kind,
                "count": len(values) // width}
        if kind == "VEC3":
            made |= {"min": [min(values[i::3]) for i in range(3)], "max": [max(values[i::3]) for i in range(3)]}
        self.json["accessors"].append(made)
        return len(self.json["accessors"]) - 1

    def mesh(self, vertices, triangles, material):
        positions = self.accessor([x for vertex in vertices for x in vertex], 3, "VEC3", 5126, "f")
        indices = self.accessor([i for triangle in triangles for i in triangle], 1, "SCALAR", 5125, "I")
        self.json["meshes"].append({"primitives": [{"attributes": {"POSITION": positions}, "indices": indices,
                                                    "material": material}]})
        self.node({"mesh": len(self.json["meshes"]) - 1})

    def quads(self, corners, material):
        """Each quad of four corners, its front counter-clockwise."""
        vertices, triangles = [], []
        for quad in corners:
            first = len(vertices)
            vertices += quad
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
        self.mesh(vertices, triangles, material)

    def write(self, path):
        out = {key: value for key, value in self.json.items() if value}
        if self.data:
            text = base64.b64encode(self.data).decode()
            out["buffers"] = [{"byteLength": len(self.data), "uri": "data:application/octet-stream;base64," + text}]
        with open(path, "w") as file:
            json.dump(out, file)


def weekend(seed=1):
    model, draw = Model(), random.Random(seed)
    model.sphere([0, -1000, 0], 1000, model.material([0.5, 0.5, 0.5]))
    glass = model.material([1, 1, 1], roughness=0, glass=True)
    for a in range(-11, 11):
        for b in range(-11, 11):
            choice, centre = draw.random(), [a + 0.9 * draw.random(), 0.2, b + 0.9 * draw.random()]
            if math.dist(centre, [4, 0.2, 0]) <= 0.9:
                continue
            if choice < 0.8:
                material = model.material([draw.random() * draw.random() for _ in range(3)])
            elif choice < 0.95:
                material = model.material([0.5 * (1 + draw.random()) for _ in range(3)], 1, 0.5 * draw.random())
            else:
                material = glass
            model.sphere(centre, 0.2, material)
    model.sphere([0, 1, 0], 1, glass)
    model.sphere([-4, 1, 0], 1, model.material([0.4, 0.2, 0.1]))
    model.sphere([4, 1, 0], 1, model.material([0.7, 0.6, 0.5], 1, 0))
    return model


def cornell(lamp):
    model, far = Model(), -555
    white = model.material([0.73, 0.73, 0.73])
    model.quads([[(0, 0, 0), (555, 0, 0), (555, 0, far), (0, 0, far)],
                 [(0, 555, 0), (0, 555, far), (555, 555, far), (555, 555, 0)],
                 [(0, 0, far), (555, 0, far), (555, 555, far), (0, 555, far)]], white)
    model.quads([[(555, 0, 0), (555, 555, 0), (555, 555, far), (555, 0, far)]], model.material([0.65, 0.05, 0.05]))
    model.quads([[(0, 0, 0), (0, 0, far), (0, 555, far), (0, 555, 0)]], model.material([0.12, 0.45, 0.15]))
    model.quads([[(213, 554, -227), (213, 554, -332), (343, 554, -332), (343, 554, -227)]],
                model.material([0.78, 0.78, 0.78], light=15 if lamp else 0))
    return model, white


def rings(centre, radii, around, bump, seed):
    """A sphere of rings, scaled along the axes; `bump` waves of some random directions stand on it."""
    draw = random.Random(seed)
    waves = [([draw.gauss(0, 6) for _ in range(3)], draw.uniform(0, math.tau)) for _ in range(12)]
    rows = around // 2
    vertices, triangles = [], []
    for row in range(rows + 1):
        for column in range(around if 0 < row < rows else 1):
            theta, phi = math.pi * row / rows, math.tau * column / around
            way = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
            high = 1 + bump * sum(math.sin(sum(w * d for w, d in zip(wave, way)) + phase)
                                  for wave, phase in waves) / len(waves)
            vertices.append(tuple(c + r * d * high for c, r, d in zip(centre, radii, way)))
    place = lambda row, column: 0 if row == 0 else len(vertices) - 1 if row == rows else 1 + (row - 1) * around + column % around
    for row in range(rows):
        for column in range(around):
            a, b = place(row, column), place(row, column + 1)
            c, d = place(row + 1, column), place(row + 1, column + 1)
            if row > 0:
                triangles.append((a, b, d))
            if row < rows - 1:
                triangles.append((a, d, c))
    return vertices, triangles


def bunny(seed=1, lamp=True):
    model, white = cornell(lamp)
    vertices, triangles = [], []
    parts = [((278, 130, -280), (140, 130, 110), 190), ((370, 260, -260), (75, 70, 65), 140),
             ((350, 370, -275), (22, 90, 14), 90), ((400, 370, -250), (22, 90, 14), 90)]
    for number, (centre, radii, around) in enumerate(parts):
        points, faces = rings(centre, radii, around, 0.12, seed + number)
        faces = [tuple(i + len(vertices) for i in face) for face in faces]
        vertices += points
        triangles += faces
    model.mesh(vertices, triangles, white)
    return model


def reflections(seed=1, lamp=True):
    model, white = cornell(lamp)
    draw = random.Random(seed)
    steel, glass = model.material([0.9, 0.9, 0.9], 1, 0), model.material([1, 1, 1], roughness=0, glass=True)
    for centre, radius, material in [((150, 100, -180), 100, steel), ((410, 90, -160), 90, glass),
                                     ((290, 60, -420), 60, steel)]:
        model.mesh(*rings(centre, (radius,) * 3, 64, 0, 0), material)
    for _ in range(24):
        low = [draw.uniform(20, 480), draw.uniform(250, 480), draw.uniform(-500, -250)]
        a, b = low, [x + draw.uniform(15, 50) for x in low]
        corner = lambda bits: tuple((b if bits >> axis & 1 else a)[axis] for axis in range(3))
        faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
        model.quads([[corner(bits) for bits in face] for face in faces], draw.choice([steel, white]))
    return model


# How it is made, its camera, the strength of its sky.
SCENES = {"weekend": (weekend, WEEKEND, 1), "bunny": (bunny, CORNELL, 0), "reflections": (reflections, CORNELL, 0),
          "bunny_unlit": (lambda: bunny(lamp=False), CORNELL, 1),
          "reflections_unlit": (lambda: reflections(lamp=False), CORNELL, 1)}
