"""The Python package, as its users call it, and the example notebook, cell by cell. CAROUSEL names the program."""

import csv
import importlib.util
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "python"))

import carousel  # noqa: E402

MACHINE = {
    "scene": {"builtin": "cornell"},
    "image": {"width": 16, "height": 16, "samples": 1, "max_depth": 2},
    "engine": {"kind": "cycle", "threads": 1, "what_if": False},
    "topology": {"resources": 4},
}


def has(module):
    return importlib.util.find_spec(module) is not None


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_run_gives_the_report(self):
        report = carousel.run(MACHINE, topology={"resources": 2}, **{"packets.rays": 16})
        self.assertEqual(report["config"]["topology"]["resources"], 2)
        self.assertEqual(report["config"]["packets"]["rays"], 16)
        self.assertGreater(report["engine"]["cycles"], 0)

    def test_run_takes_a_file_and_keeps_its_folder(self):
        path = self.folder / "machine.json"
        path.write_text(json.dumps(MACHINE))
        report = carousel.run(path, out=self.folder / "out")
        self.assertEqual(report, carousel.load_report(self.folder / "out"))
        self.assertTrue((report.folder / "image.png").exists())

    def test_errors_know_their_position(self):
        path = self.folder / "bad.yaml"
        path.write_text("scene: {builtin: cornell}\ntopology:\n  resorces: 4\n")
        with self.assertRaises(carousel.ConfigError) as caught:
            carousel.run(path)
        problem = caught.exception.problems[0]
        self.assertEqual((problem.file, problem.line, problem.column), (str(path), 3, 3))
        self.assertIn("did you mean 'resources'?", problem.message)
        self.assertEqual(caught.exception.status, 2)
        with self.assertRaises(carousel.ConfigError):
            carousel.sweep(MACHINE, vary={"topology.resources": [0, 2]})

    def test_sweep_gives_rows_and_goes_on(self):
        vary = {"topology.resources": [2, 4], ("memory.l2_kib", "packets.rays"): [(64, 8), (512, 32)]}
        rows = carousel.sweep(MACHINE, vary=vary, out=self.folder / "out", exclude=["topology.resources=4,packets.rays=8"])
        self.assertEqual([tuple(row["keys"].values()) for row in rows], [(2, 64, 8), (2, 512, 32), (4, 512, 32)])
        alone = carousel.run(MACHINE, **{"topology.resources": 2, "memory.l2_kib": 512, "packets.rays": 32})
        self.assertEqual(rows[1]["results"]["cycles"], alone["engine"]["cycles"])
        times = {path: path.stat().st_mtime_ns for path in (self.folder / "out" / "points").iterdir()}
        again = carousel.sweep(MACHINE, vary=vary, out=self.folder / "out")
        self.assertEqual(len(again), 4)
        for path, time in times.items():
            self.assertEqual(path.stat().st_mtime_ns, time)
        with open(self.folder / "out" / "sweep.csv", newline="") as table:
            self.assertEqual(len(list(csv.DictReader(table))), 4)

    def test_failed_points_are_rows(self):
        scene = self.folder / "bad.gltf"
        scene.write_text("{}")
        rows = carousel.sweep(MACHINE, scenes=["builtin:cornell", scene])
        self.assertEqual([row["status"] for row in rows], ["done", "failed"])
        self.assertEqual(rows[1]["error"]["kind"], "scene")

    @unittest.skipUnless(has("numpy"), "NumPy is not installed")
    def test_arrays(self):
        report = carousel.run(MACHINE, image={"width": 24, "height": 16})
        picture = carousel.picture(report)
        self.assertEqual(picture.shape, (16, 24, 3))
        self.assertGreater(picture.std(), 5)
        times, unit, rows = carousel.time_series(report)
        self.assertEqual(unit, "cycles")
        for values in rows.values():
            self.assertEqual(values.shape, times.shape)

    @unittest.skipUnless(has("numpy"), "NumPy is not installed")
    def test_png_filters(self):
        """Every filter of PNG, against lines filtered here by the definition."""
        import struct
        import zlib

        from carousel.tables import _decode_png
        width, step = 5, 3
        lines = [[(17 * x * x + 31 * y * y + 7 * x * y) % 256 for x in range(width * step)] for y in range(5)]
        raw = b""
        for y, line in enumerate(lines):
            up = lines[y - 1] if y else [0] * len(line)
            raw += bytes([y])  # filter types 0 to 4
            for i, value in enumerate(line):
                left = line[i - step] if i >= step else 0
                corner = up[i - step] if i >= step else 0
                p = left + up[i] - corner
                distances = [abs(p - left), abs(p - up[i]), abs(p - corner)]
                paeth = [left, up[i], corner][distances.index(min(distances))]
                raw += bytes([(value - [0, left, up[i], (left + up[i]) // 2, paeth][y]) % 256])
        chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + b"\0\0\0\0"  # noqa: E731
        png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, 5, 8, 2, 0, 0, 0))
        png += chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")
        self.assertEqual(_decode_png(png).reshape(5, -1).tolist(), lines)

    @unittest.skipUnless(has("pandas"), "pandas is not installed")
    def test_frame(self):
        rows = carousel.sweep(MACHINE, vary={"topology.resources": "1..4*2"})
        table = carousel.frame(rows)
        self.assertEqual(list(table["topology.resources"]), [1, 2, 4])
        self.assertEqual(list(table["cycles"]), [row["results"]["cycles"] for row in rows])
        reports = carousel.frame([carousel.run(MACHINE)])
        self.assertIn("throughput.whole.rays_per_kilocycle", reports.columns)

    def test_notebook(self):
        notebook = json.loads((SOURCE / "python" / "examples" / "sweep.ipynb").read_text())
        names = {}
        before = Path.cwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        for cell in notebook["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), "sweep.ipynb", "exec"), names)
        self.assertEqual(len(names["rows"]), 6)


if __name__ == "__main__":
    unittest.main()
