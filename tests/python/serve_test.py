"""carousel serve: what it shows, and what it refuses. CAROUSEL names the program."""

import http.client
import json
import os
import re
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

CAROUSEL = os.environ["CAROUSEL"]
CONFIG = """scene: {builtin: cornell}
image: {width: 8, height: 8, samples: 1, max_depth: 2}
engine: {kind: cycle, what_if: false}
rays: {slots_per_resource: 64}
topology: {resources: 2}
"""


def carousel(folder, *words):
    subprocess.run([CAROUSEL, *words], cwd=folder, check=True, capture_output=True)


class Serve(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        folder = cls.folder = Path(cls.temporary.name)
        (folder / "a.yaml").write_text(CONFIG)
        (folder / "secret.json").write_text("{}")
        carousel(folder, "run", "a.yaml", "--out", "out/run one", "--quiet")
        carousel(folder, "sweep", "a.yaml", "--vary", "topology.resources=2,4", "--out", "out/sweep", "--quiet")
        carousel(folder, "sweep", "a.yaml", "--vary", "topology.resources=2,4", "--out", "out/live", "--quiet")
        for name in ("sweep.json", "sweep.html", "sweep.csv"):
            (folder / "out" / "live" / name).unlink()
        (folder / "out" / "way_out").symlink_to(folder)
        (folder / "out" / ".hidden.json").write_text("{}")
        cls.before = cls.files()
        cls.server = subprocess.Popen([CAROUSEL, "serve", "out"], cwd=folder, stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, text=True)
        line = cls.server.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", line)
        if not found:
            cls.server.kill()
            error = cls.server.stderr.read()
            cls.temporary.cleanup()
            if "libcpp-httplib-dev" in error:
                raise unittest.SkipTest("the module http is not built")
            raise AssertionError(line + error)
        cls.port, cls.token = int(found.group(1)), found.group(2)

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()   # tests in the background of a shell ignore SIGINT
        status = cls.server.wait(20)
        cls.server.stdout.close()
        cls.server.stderr.close()
        after = cls.files()
        cls.temporary.cleanup()
        assert status == 0, status
        assert after == cls.before, set(after) ^ set(cls.before)

    @classmethod
    def files(cls):
        return sorted((str(p), p.stat().st_mtime_ns) for p in (cls.folder / "out").rglob("*")
                      if p.is_file() and cls.folder / "out/sweep/asked" not in p.parents)

    def ask(self, path, method="GET", host=None, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        connection.putrequest(method, path, skip_host=True)
        connection.putheader("Host", f"127.0.0.1:{self.port}" if host is None else host)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        return answer, text

    def site(self, path, **more):
        return self.ask(f"/{self.token}/{path}", **more)

    def test_lists_and_shows_results(self):
        answer, text = self.site("")
        self.assertEqual(answer.status, 200)
        self.assertEqual(answer.getheader("Cache-Control"), "no-store")
        self.assertEqual(answer.getheader("Referrer-Policy"), "no-referrer")
        for link in (b"0/run%20one/", b"0/sweep/", b"0/live/"):
            self.assertIn(link, text)
        answer, text = self.site("0/run%20one/")
        self.assertEqual(answer.status, 200)
        self.assertIn(b"What limits it", text)
        self.assertEqual(json.loads(self.site("0/run%20one/report.json")[1])["engine"]["kind"], "cycle")
        self.assertEqual(self.site("0/run%20one/image.png")[0].getheader("Content-Type"), "image/png")
        self.assertIn(b"Pareto front", self.site("0/sweep/sweep.html")[1])
        point = next((self.folder / "out/sweep/points").glob("*.json")).stem
        self.assertIn(b"What a ray costs", self.site(f"0/sweep/points/{point}.html")[1])

    def test_shows_a_sweep_that_is_not_done(self):
        answer, text = self.site("0/live/")
        self.assertEqual(answer.status, 200)
        self.assertIn(b"2 points are finished", text)
        self.assertIn(b'http-equiv="refresh"', text)

    def test_refuses_without_the_token(self):
        for path in ("/", "/0/", f"/{'0' * 32}/", f"/{self.token[:-1]}/", f"/{self.token}0/0/", "//", f"/x/{self.token}/"):
            answer, text = self.ask(path)
            self.assertEqual(answer.status, 404, path)
            self.assertNotIn(b"run", text)

    def test_refuses_other_hosts(self):
        for host in ("example.org", f"example.org:{self.port}", "127.0.0.1", f"127.0.0.1:{self.port + 1}", ""):
            self.assertIn(self.site("", host=host)[0].status, (400, 421), host)
        self.assertEqual(self.site("", host=f"localhost:{self.port}")[0].status, 200)

    def test_refuses_what_lies_outside(self):
        for path in ("0/../secret.json", "0/..%2fsecret.json", "0/%2e%2e/secret.json", "0/run%20one/../../../secret.json",
                     "0/way_out/secret.json", "0/way_out/", "0//etc/passwd", "0/.hidden.json", "0/%00", "1/", "-1/", "0x/",
                     "99999999999/", "0/a.yaml/", "0/..%5csecret.json", "0/nothing.json", "0/live/sweep.lock"):
            self.assertEqual(self.site(path)[0].status, 404, path)

    def test_refuses_other_methods(self):
        for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS"):
            self.assertIn(self.site("0/sweep/sweep.json", method=method, body=b"x")[0].status, (400, 405), method)
        answer, text = self.site("", method="HEAD")
        self.assertEqual((answer.status, text), (200, b""))

    def simulate(self, query, path="0/sweep/ask", **more):
        return self.site(f"{path}?{query}", method="POST", **more)

    def done(self, query):
        """How the run of a point is when it goes on no more."""
        answer, text = self.simulate(query)
        self.assertEqual(answer.status, 202, text)
        for _ in range(200):
            state = json.loads(self.site(f"0/sweep/ask?name={json.loads(text)['name']}")[1])
            if state["state"] != "running":
                break
            time.sleep(0.1)
        return state

    def test_simulates_a_point_between_those_of_a_sweep(self):
        state = self.done("topology.resources=3")
        name = json.loads(self.simulate("topology.resources=3")[1])["name"]
        self.assertEqual(state["state"], "done", state)
        carousel(self.folder, "run", "a.yaml", "--set", "topology.resources=3", "--out", "three", "--quiet")
        report = json.loads((self.folder / "three/report.json").read_text())
        self.assertEqual(state["results"]["cycles"], report["engine"]["cycles"])
        self.assertIn(b"What limits it", self.site("0/sweep/" + state["page"])[1])
        written = {p.name for p in (self.folder / "out/sweep/asked").iterdir()}
        self.assertEqual({one for one in written if one.startswith(name)}, {name, name + ".config.json", name + ".log"})
        # It is not run again.
        before = (self.folder / "out/sweep/asked" / name / "report.json").stat().st_mtime_ns
        self.assertEqual(json.loads(self.simulate("topology.resources=3")[1]), {"name": name})
        self.assertEqual((self.folder / "out/sweep/asked" / name / "report.json").stat().st_mtime_ns, before)

    def test_an_interrupted_run_is_no_result(self):
        """Such as that of a server that ended meanwhile: its report has what was simulated until then."""
        self.assertEqual(self.done("topology.resources=2")["state"], "done")
        name = json.loads(self.simulate("topology.resources=2")[1])["name"]
        file = self.folder / "out/sweep/asked" / name / "report.json"
        report = json.loads(file.read_text())
        whole = report["engine"]["cycles"]
        del report["checksum"]
        report["incomplete"] = True
        report["engine"]["cycles"] = whole // 2
        file.write_text(json.dumps(report))
        self.assertEqual(json.loads(self.site(f"0/sweep/ask?name={name}")[1]),
                         {"state": "failed", "error": "the run was interrupted; ask again"})
        self.assertEqual(self.done("topology.resources=2")["results"]["cycles"], whole)

    def test_refuses_other_points(self):
        for query, message in (("", b"expected a value"), ("topology.resources=5", b"from 2 to 4"),
                               ("topology.resources=2.5", b"an integer"), ("topology.resources=3;x", b"an integer"),
                               ("topology.resources=[3]", b"an integer"), ("image.width=8&topology.resources=3", b"no key of"),
                               ("topology.resources=3&topology.resources=2", b"expected once"),
                               ("topology.resources=3&out=/tmp/x", b"no key of")):
            answer, text = self.simulate(query)
            self.assertEqual(answer.status, 400, query)
            self.assertIn(message, text, query)
        for path in ("ask", "0/ask", "0/run%20one/ask", "0/way_out/ask", "0/../ask", "0/live/ask", "9/ask"):
            self.assertIn(self.simulate("topology.resources=3", path)[0].status, (404, 405), path)
        for name in ("x", "../../secret", "0" * 32, ""):
            self.assertEqual(self.site(f"0/sweep/ask?name={name}")[0].status, 404, name)
        self.assertEqual(self.ask(f"/{'0' * 32}/0/sweep/ask?topology.resources=3", method="POST")[0].status, 404)
        self.assertEqual(self.simulate("topology.resources=3", host="example.org")[0].status, 421)

    def test_idle_connections_keep_nobody_waiting(self):
        # Each is closed after two seconds, and a server with a thread for eight of them would close some first.
        idle = [socket.create_connection(("127.0.0.1", self.port)) for _ in range(40)]
        try:
            self.assertEqual(self.site("")[0].status, 200)
            for one in idle:
                one.setblocking(False)
                with self.assertRaises(BlockingIOError):
                    one.recv(1)
        finally:
            for one in idle:
                one.close()

    def test_no_other_address(self):
        others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
        for address in sorted(others | {"127.0.0.2"}):
            with self.assertRaises(OSError, msg=address):
                socket.create_connection((address, self.port), timeout=2).close()


class Usage(unittest.TestCase):
    def test_a_folder_that_is_not_there(self):
        done = subprocess.run([CAROUSEL, "serve", "/nowhere/at/all"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertNotIn("http://", done.stdout)


if __name__ == "__main__":
    unittest.main()
