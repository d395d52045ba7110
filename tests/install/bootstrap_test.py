"""script/bootstrap with an apt-get that fetches nothing: it says before how much it will bring, and shows its progress."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

BOOTSTRAP = Path(__file__).resolve().parents[2] / "script" / "bootstrap"

APT_GET = r"""#!/bin/sh
case "$*" in
  *--print-uris*) cat <<'END'
The following NEW packages will be installed:
After this operation, 12.3 MB of additional disk space will be used.
'http://deb/a.deb' a.deb 1048576 MD5Sum:1
'http://deb/b.deb' b.deb 1572864 MD5Sum:2
'http://deb/c.deb' c.deb 10 MD5Sum:3
END
  ;;
  *install*) for part in 0 10 50.5 100; do echo "dlstatus:1:$part:Retrieving"; done
    echo "Unpacking a ..."
    for part in 0.0 12.5 99.9; do echo "pmstatus:a:$part:Installing a"; done
    echo "$*" >"$LOG" ;;
esac
exit ${FAILS:-0}
"""


class Bootstrap(unittest.TestCase):
    def call(self, **environment):
        with tempfile.TemporaryDirectory() as folder:
            tools = {"apt-get": APT_GET, "dpkg-query": "#!/bin/sh\n[ $4 = g++ ] || echo install ok installed\n",
                     "id": "#!/bin/sh\necho 0\n", "npm": "#!/bin/sh\nexit 0\n", "node": "#!/bin/sh\nexit 0\n"}
            for name, text in tools.items():
                path = Path(folder) / name
                path.write_text(text)
                path.chmod(0o755)
            script = Path(folder) / "script" / "bootstrap"
            script.parent.mkdir()
            script.write_text(BOOTSTRAP.read_text())
            (Path(folder) / "web" / "node_modules").mkdir(parents=True)
            (Path(folder) / "web" / "package-lock.json").write_text('"node_modules/a"\n"node_modules/b"\n')
            log = Path(folder) / "log"
            done = subprocess.run(["bash", script, "release"], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "LOG": str(log), **environment})
            return done, log.read_text() if log.exists() else ""

    def test_it_says_how_much_it_will_bring_and_how_far_it_is(self):
        done, log = self.call()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("Installing 1 Debian packages, 3 with all that they need: 3 MiB to fetch, 12.3 MB on disk", done.stdout)
        self.assertIn("Fetching 2 packages from npm", done.stdout)
        progress = [line.strip() for line in done.stdout.splitlines() if " % " in line]
        self.assertEqual(progress, ["0 % fetched", "50 % fetched", "100 % fetched", "0 % installed", "99 % installed"])
        self.assertIn("g++", log)
        self.assertNotIn("cmake", log)

    def test_a_failure_of_apt_ends_it(self):
        self.assertNotEqual(self.call(FAILS="100")[0].returncode, 0)


if __name__ == "__main__":
    unittest.main()
