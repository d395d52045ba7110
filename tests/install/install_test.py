"""cmake --install into an empty folder; what stands there works, and examples/ build against it and run.

CAROUSEL_BUILD names the build folder. Nothing of the project is compiled here but the examples.
"""

import gzip
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = os.environ["CAROUSEL_BUILD"]


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        raise AssertionError(f"{words} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="carousel_install_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.prefix = Path(cls.folder.name) / "prefix"
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.program = cls.prefix / "bin" / "carousel"

    def one(self, pattern):
        found = list(self.prefix.glob(pattern))
        self.assertEqual(len(found), 1, pattern)
        return found[0]

    def test_all_is_there(self):
        for pattern in ("share/man/man1/carousel.1.gz", "share/bash-completion/completions/carousel",
                        "share/zsh/*/_carousel", "share/carousel/configs/demo.yaml", "share/carousel/configs/schema.json",
                        "share/doc/carousel/guides/tutorial.md", "share/doc/carousel/README.md",
                        "share/doc/carousel/copyright",
                        "share/doc/carousel-dev/examples/own_queue.cpp", "include/carousel/core/config/config.h",
                        "lib/**/libcarousel_core.a", "lib/**/CarouselConfig.cmake"):
            self.assertGreater(self.one(pattern).stat().st_size, 0, pattern)
        self.assertEqual(list(self.prefix.glob("**/*.cpp")),
                         list(self.prefix.glob("share/doc/carousel-dev/examples/*.cpp")))

    def test_notices_hold_every_library_that_is_compiled_in(self):
        notices = gzip.decompress(self.one("share/doc/carousel/NOTICES.gz").read_bytes()).decode()
        wanted = re.findall(r"^(?:release|modules)=\(([^)]*)\)", (SOURCE / "script/bootstrap").read_text(), re.M)
        self.assertEqual(len(wanted), 2)
        wanted = [name for name in " ".join(wanted).split() if name.endswith("-dev")]
        self.assertGreater(len(wanted), 15)
        for name in wanted:
            self.assertIn(f"======== {name} ", notices)
        for words in ("G-Truc Creation", "Niels Lohmann", "Henry Schreiner", "Cameron Desrochers", "zrender"):
            self.assertIn(words, notices)

    def test_the_bill_of_materials_names_what_the_program_loads(self):
        bill = json.loads(self.one("share/doc/carousel/carousel.spdx.json").read_text())
        self.assertEqual(bill["spdxVersion"], "SPDX-2.3")
        versions = {package["name"]: package["versionInfo"] for package in bill["packages"]}
        identities = {package["SPDXID"] for package in bill["packages"]}
        self.assertEqual(len(identities), len(bill["packages"]))
        for relation in bill["relationships"]:
            self.assertIn(relation["relatedSpdxElement"], identities)
        modules = sorted(self.prefix.glob("lib/carousel/modules/*.so"))
        self.assertGreater(len(modules), 1)
        loaded = set(re.findall(r"=> (/\S+)", run("ldd", self.program, *modules)))
        self.assertGreater(len(loaded), 15)
        # Where /lib is a link to /usr/lib, packages may list either name. What alternatives provide is a link to a file.
        def names_of(library):
            return library, "/usr" + library, os.path.realpath(library)
        names = [name for library in loaded for name in names_of(library)]
        found = subprocess.run(["dpkg-query", "-S", *names], capture_output=True, text=True, check=False).stdout
        owners = dict(reversed(line.split(": ", 1)) for line in found.splitlines())
        installed = dict(line.split(" ") for line in
                         run("dpkg-query", "-W", "-f", "${Package} ${Version}\n").splitlines())
        for library in loaded:
            owner = next(owners[name] for name in names_of(library) if name in owners).split(":")[0]
            self.assertEqual(versions[owner], installed[owner], library)
        for name in ("libglm-dev", "nlohmann-json3-dev", "echarts"):
            self.assertIn(name, versions)

    def test_one_version_everywhere(self):
        version = re.search(r'^version = "(.*)"', (SOURCE / "python/pyproject.toml").read_text(), re.M)[1]
        self.assertEqual(run(self.program, "--version").splitlines()[0], f"carousel {version}")
        self.assertEqual(re.search("^## (.*)", (SOURCE / "CHANGELOG.md").read_text(), re.M)[1], version)
        self.assertIn(f'PACKAGE_VERSION "{version}"', self.one("lib/**/CarouselConfigVersion.cmake").read_text())
        self.assertIn(f"Carousel {version}", gzip.decompress(self.one("share/man/man1/carousel.1.gz").read_bytes()).decode())

    def test_modules_are_opened_from_the_folder_beside_the_program(self):
        text = run(self.program, "--version", "--verbose")
        self.assertIn(f"modules in {self.prefix}/lib/carousel/modules", text)
        self.assertIn("OpenImageIO ", text)
        self.assertNotIn("refused", text)
        for module in self.prefix.glob("lib/carousel/modules/*.so"):
            # They come with the system: no path of the build stays in them.
            self.assertNotIn("RUNPATH", run("readelf", "-d", module))
        out = Path(self.folder.name) / "tiff"
        run(self.program, "run", self.prefix / "share/carousel/configs/demo.yaml", "--quiet", "--out", out, "--set",
            "image.width=8", "--set", "image.height=8", "--set", "image.samples=1", "--set", "image.files=[tiff]")
        self.assertTrue((out / "image.tiff").exists())

    def test_nothing_names_the_sources(self):
        for file in self.prefix.glob("lib/**/*.cmake"):
            self.assertNotIn(str(SOURCE), file.read_text(), file)

    def test_the_program_runs_every_configuration(self):
        found = [file for file in (self.prefix / "share/carousel/configs").rglob("*.*")
                 if file.suffix in (".yaml", ".json") and file.name != "schema.json"]
        self.assertGreaterEqual(len(found), 8)
        self.assertIn(".json", [file.suffix for file in found])
        for config in found:
            run(self.program, "check", config)
            self.assertRegex(config.read_text(), r'(?m)^(# yaml-language-server: \$schema=| +"\$schema": ")(\.\./)?schema.json')

    def test_python_finds_the_program(self):
        package = self.one("lib/**/carousel/__init__.py").parent.parent
        code = ("import carousel; report = carousel.run({'scene': {'builtin': 'cornell'}}, image={'width': 8, 'height': 8});"
                "print(report['rays']['lost'])")
        env = {**os.environ, "PYTHONPATH": str(package), "PATH": f"{self.program.parent}:{os.environ['PATH']}",
               "PYTHONDONTWRITEBYTECODE": "1"}
        env.pop("CAROUSEL", None)
        self.assertEqual(run(sys.executable, "-c", code, env=env).strip(), "0")

    # The page of plugins builds one as well; the others are compiled with the tests.
    @unittest.skipUnless(float(os.environ.get("CAROUSEL_EFFORT", "1")) >= 1, "takes long: CAROUSEL_EFFORT=1 runs it")
    def test_the_examples_build_and_run(self):
        build = Path(self.folder.name) / "examples"
        run("cmake", "-S", self.prefix / "share/doc/carousel-dev/examples", "-B", build, "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={self.prefix}", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O0")
        run("cmake", "--build", build)
        self.assertIn("2000 of 2000 beams met a surface", run(build / "own_program"))
        # The installed program knows what the plugins bring.
        parts = ("queue", "policy", "placement", "workload", "prefetcher")
        plugins = ", ".join(str(build / f"libown_{part}.so") for part in parts)
        machine = self.prefix / "share/doc/carousel-dev/examples/plugins.yaml"
        words = [self.program, "run", machine, "--json", "--set", f"engine.plugins=[{plugins}]", "--out"]
        report = json.loads(run(*words, build / "native"))
        self.assertEqual([plugin["brings"] for plugin in report["plugins"]],
                         [["queue fast_forward"], ["policy broad_first"], ["placement octants"], ["workload scanner"],
                          ["prefetcher pairs"]])
        self.assertEqual(report["links"][0]["queue"], "fast_forward")
        self.assertEqual((report["rays"]["by_kind"]["camera"], report["rays"]["lost"]), (2000, 0))
        cycles = json.loads(run(*words, build / "cycle", "--set", "engine.kind=cycle", "--set",
                                "topology.link.queue=spsc_ring", "--set", "prefetcher={lines: 2, rule: pairs}"))
        self.assertGreater(cycles["prefetcher"]["hints"], 0)
        self.assertEqual(report["digest"], cycles["digest"])
        run(self.program, "stress", "--plugin", build / "libown_queue.so", "--queue", "fast_forward", "--pattern",
            "stream", "--messages", "20000", "--seconds", "1", "--out", build / "stress")

    def test_the_page_of_plugins_works(self):
        page = (self.prefix / "share/doc/carousel/guides/plugins.md").read_text()
        blocks = re.findall(r"```sh\n(.*?)```", page, re.S)
        self.assertEqual(len(blocks), 2)
        folder = Path(self.folder.name) / "page"
        folder.mkdir()
        environment = {**os.environ, "PATH": f"{self.program.parent}:{os.environ['PATH']}",
                       "CMAKE_PREFIX_PATH": str(self.prefix)}
        printed = [run("bash", "-euo", "pipefail", "-c", text, cwd=folder, env=environment) for text in blocks]
        self.assertIn("narrowest", printed[1])
        report = json.loads((folder / "mine/report.json").read_text())
        self.assertEqual(report["plugins"][0]["brings"], ["policy narrowest", "placement roomiest"])
        self.assertEqual(report["config"]["rays"]["placement"], "roomiest")


if __name__ == "__main__":
    unittest.main()
