"""clang-tidy takes what it finds for an error, and script/tidy gives it the files that it is asked for."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="carousel_tidy_")
        self.addCleanup(folder.cleanup)
        os.chdir(folder.name)
        self.addCleanup(os.chdir, SOURCE)

    def write(self, name, text):
        pathlib.Path(name).parent.mkdir(parents=True, exist_ok=True)
        pathlib.Path(name).write_text(text, encoding="utf-8")


@unittest.skipUnless(shutil.which("clang-tidy"), "clang-tidy is not installed")
class Findings(InAFolder):
    def test_findings_are_errors(self):
        self.write("planted.cpp", "struct A {\n  A& operator=(const A& other) {\n    delete p;\n    p = new int(*other.p);\n"
                   "    return *this;\n  }\n  int* p;\n};\n")
        self.write("sound.cpp", "struct A {\n  int p;\n};\n")
        for name, status in (("planted.cpp", 1), ("sound.cpp", 0)):
            command = ["clang-tidy", f"--config-file={SOURCE / '.clang-tidy'}", "--quiet", name, "--", "-std=c++20"]
            done = subprocess.run(command, text=True, capture_output=True, check=False)
            self.assertEqual(done.returncode, status, done.stdout + done.stderr)
            self.assertEqual("bugprone-unhandled-self-assignment" in done.stdout, status == 1, done.stdout)


class TidyScript(InAFolder):
    """script/tidy with a clang-tidy and a CMake that only note what they are given."""

    def call(self, *arguments):
        shutil.copytree(SOURCE / "script", "script")
        self.write("core/a.cpp", "")
        self.write("core/b.cpp", "")
        self.write("ringbus/cycle/c.cpp", "")
        self.write("tests/d.cpp", "")
        subprocess.run(["git", "init", "-q", "."], check=True)
        subprocess.run(["git", "add", "core", "ringbus", "tests"], check=True)
        self.write("bin/cmake", "#!/bin/sh\nmkdir -p build/tidy\n")
        self.write("bin/protoc", "#!/bin/sh\n")
        self.write("bin/clang-tidy", "#!/bin/sh\nfor file; do :; done\necho \"$file\" >>seen\n[ $file != core/b.cpp ]\n")
        for tool in pathlib.Path("bin").iterdir():
            tool.chmod(0o755)
        done = subprocess.run(["script/tidy", *arguments], text=True, capture_output=True, check=False,
                              env={**os.environ, "PATH": f"{os.getcwd()}/bin:{os.environ['PATH']}"})
        seen = sorted(pathlib.Path("seen").read_text(encoding="utf-8").split()) if pathlib.Path("seen").exists() else []
        return done.returncode, done.stdout.splitlines(), seen

    def test_all_product_sources(self):
        self.assertEqual(self.call(), (1, ["3 files"], ["core/a.cpp", "core/b.cpp", "ringbus/cycle/c.cpp"]))

    def test_a_part(self):
        status, out, seen = self.call("--part", "1/2")
        self.assertEqual((status, out, seen), (0, ["2 files"], ["core/a.cpp", "ringbus/cycle/c.cpp"]))

    def test_named_files(self):
        self.assertEqual(self.call("core/a.cpp"), (0, ["1 files"], ["core/a.cpp"]))

    def test_an_impossible_part(self):
        self.assertEqual(self.call("--part", "2/2"), (2, [], []))


if __name__ == "__main__":
    unittest.main()
