"""Small models in glTF 2.0, their buffers and pictures in the file itself."""
import base64
import json
import struct
import zlib


def uri(kind, data):
    return f"data:{kind};base64," + base64.b64encode(data).decode()


def png(texels):
    """A picture of rows of (red, green, blue, alpha)."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    rows = b"".join(b"\0" + bytes(value for texel in row for value in texel) for row in texels)
    head = struct.pack(">IIBBBBB", len(texels[0]), len(texels), 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


class Model:
    def __init__(self):
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "accessors": [], "bufferViews": [], "materials": []}
        self.data = b""

    def floats(self, rows):
        width = len(rows[0])
        self.json["accessors"].append({
            "bufferView": len(self.json["bufferViews"]), "componentType": 5126, "count": len(rows),
            "type": {2: "VEC2", 3: "VEC3"}[width], "min": [min(column) for column in zip(*rows)],
            "max": [max(column) for column in zip(*rows)]})
        data = struct.pack(f"<{width * len(rows)}f", *[x for row in rows for x in row])
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return len(self.json["accessors"]) - 1

    def material(self, **fields):
        self.json["materials"].append(fields)
        return len(self.json["materials"]) - 1

    def texture(self, texels, sampler):
        self.json["images"] = [{"uri": uri("image/png", png(texels))}]
        self.json["samplers"] = [sampler]
        self.json["textures"] = [{"source": 0, "sampler": 0}]

    def mesh(self, *parts):
        """Parts are (material, positions, texture coordinates or None), three corners a triangle."""
        primitives = []
        for material, positions, coordinates in parts:
            attributes = {"POSITION": self.floats(positions)}
            if coordinates:
                attributes["TEXCOORD_0"] = self.floats(coordinates)
            primitives.append({"attributes": attributes, "material": material})
        self.json["meshes"].append({"primitives": primitives})
        return len(self.json["meshes"]) - 1

    def node(self, mesh, **fields):
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]))
        self.json["nodes"].append({"mesh": mesh, **fields})

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.data), "uri": uri("application/octet-stream", self.data)}]
        path.write_text(json.dumps({name: value for name, value in self.json.items() if value != []}))
