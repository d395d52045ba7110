"""The small files that examples of docs/reference name, written into a folder: a model that moves, rays, requests to the
memory, trees, and the plugins of examples/, where they were built with the program."""
import base64
import json
import pathlib
import struct
import subprocess
import sys


def moving_model():
    """A glTF of one triangle with a light, two cameras, and an animation that shifts it within two seconds."""
    parts = [struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0), struct.pack("<2f", 0, 2), struct.pack("<6f", 0, 0, 0, 0.4, 0, 0)]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    data = base64.b64encode(b"".join(parts)).decode()
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                 {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
                 {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}]
    nodes = [{"name": "triangle", "mesh": 0}, *({"camera": i, "translation": [0, 0, 3]} for i in range(2)),
             {"extensions": {"KHR_lights_punctual": {"light": 0}}}]
    return json.dumps({
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": at, "uri": "data:application/octet-stream;base64," + data}],
        "bufferViews": views, "accessors": accessors, "nodes": nodes, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"doubleSided": True, "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": angle, "znear": 0.1}} for angle in (0.8, 1.2)],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}},
        "animations": [{"name": "shift", "samplers": [{"input": 1, "output": 2}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]})


RAYS = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n" + "".join(f"{i},camera,0,1,4,{i / 100},0,-1,0,inf\n" for i in range(40))


def write(program, folder, root):
    """Writes them all. Paths of configs/ and of built plugins are links."""
    folder, program = pathlib.Path(folder), pathlib.Path(program).resolve()
    (folder / "moving.gltf").write_text(moving_model())
    (folder / "rays.csv").write_text(RAYS)
    (folder / "small.yaml").write_text("scene: {builtin: cornell}\nimage: {width: 8, height: 8, samples: 1}\n"
                                       "engine: {kind: cycle, what_if: false}\n")
    (folder / "drawn.yaml").write_text("scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology: {shape: graph, "
                                       "nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}\n")
    subprocess.run([program, "run", "small.yaml", "--dump-trees", "cornell.trees", "--dump-memory", "requests.csv", "--no-html",
                    "--quiet", "--out", "small"], cwd=folder, check=True)
    (folder / "configs").symlink_to(pathlib.Path(root).resolve() / "configs")
    plugins = program.parent / "tests/plugins"
    if plugins.is_dir():
        (folder / "build").symlink_to(plugins)


def main():
    if len(sys.argv) != 3:
        print(f"usage: {sys.argv[0]} CAROUSEL FOLDER", file=sys.stderr)
        return 2
    pathlib.Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
    write(sys.argv[1], sys.argv[2], pathlib.Path(__file__).resolve().parents[2])
    return 0


if __name__ == "__main__":
    sys.exit(main())
