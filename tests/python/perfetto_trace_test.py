"""A timeline in Perfetto's protobuf says the same as the one in Chrome's JSON.

Reads the file by the rules of the wire format (protobuf.dev/programming-guides/encoding) and the numbers of the fields in
Perfetto's trace.proto, trace_packet.proto, track_descriptor.proto and track_event.proto, not with the program's own
description of them.
"""
import collections
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

CONFIG = """
scene: {builtin: cornell}
image: {width: 16, height: 16, samples: 1, max_depth: 2}
engine: {kind: cycle, what_if: false}
topology: {resources: 3}
rays: {slots_per_resource: 32}
"""


def fields(data):
    """The fields of a message: lists of values by number; a nested message is bytes."""
    out = collections.defaultdict(list)
    at = 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(data):
        key = varint()
        kind = key & 7
        if kind == 0:
            value = varint()
        elif kind == 1:
            value = data[at:at + 8]
            at += 8
        elif kind == 2:
            size = varint()
            value = data[at:at + size]
            assert len(value) == size, "a field ends after the file"
            at += size
        else:
            raise AssertionError(f"wire type {kind}")
        out[key >> 3].append(value)
    return out


def of_perfetto(data):
    """Slices, counters and flows of a file, as sorted lists; checks that slices of a track are nested and in order."""
    names, parents, counter_tracks, open_slices, last = {}, {}, set(), {}, collections.defaultdict(int)
    slices, counters, flows, ended = [], [], collections.defaultdict(list), []
    for packet in map(fields, fields(data)[1]):
        assert packet[10] == [1]
        if packet[60]:
            track = fields(packet[60][0])
            uuid = track[1][0]
            assert uuid not in names
            names[uuid] = (fields(track[3][0])[6] if track[3] else track[2])[0].decode()
            if track[5]:
                assert track[5][0] in names
                parents[uuid] = names[track[5][0]]
            if track[8]:
                counter_tracks.add(uuid)
            continue
        time, event = packet[8][0], fields(packet[11][0])
        kind, uuid = event[9][0], event[11][0]
        track = (parents[uuid], names[uuid])
        if kind == 4:
            assert uuid in counter_tracks
            counters.append((*track, time, struct.unpack("<d", event[44][0])[0]))
            continue
        assert uuid not in counter_tracks and time >= last[uuid]
        last[uuid] = time
        if kind == 1:
            assert uuid not in open_slices, "a slice begins within another"
            notes = {fields(note)[10][0].decode(): fields(note)[4][0] for note in event[4]}
            open_slices[uuid] = (*track, event[23][0].decode(), event[22][0].decode(), notes.get("packet"),
                                 notes.get("rays"), time)
            for flow in event[47] + event[48]:
                flows[struct.unpack("<Q", flow)[0]].append((*track, time))
            ended += [struct.unpack("<Q", flow)[0] for flow in event[48]]
        else:
            assert kind == 2
            slices.append((*open_slices.pop(uuid), time))
    assert not open_slices
    assert sorted(ended) == sorted(flows), "each flow ends once"
    return sorted(slices, key=repr), sorted(counters), sorted(flows.values())


def of_chrome(trace):
    processes, tracks = {}, {}
    slices, counters, flows = [], [], collections.defaultdict(list)
    for event in trace["traceEvents"]:
        place = (event["pid"], event["tid"])
        if event["name"] == "process_name":
            processes[event["pid"]] = event["args"]["name"]
        elif event["name"] == "thread_name":
            tracks[place] = event["args"]["name"]
        elif event["ph"] == "X":
            slices.append((processes[event["pid"]], tracks[place], event["name"], event["cat"],
                           event.get("args", {}).get("packet"), event.get("args", {}).get("rays"),
                           1000 * event["ts"], 1000 * (event["ts"] + event["dur"])))
        elif event["ph"] == "C":
            counters.append((processes[event["pid"]], event["name"], 1000 * event["ts"], event["args"]["value"]))
        elif event["ph"] in "stf":
            flows[event["id"]].append((processes[event["pid"]], tracks[place], 1000 * event["ts"]))
    return sorted(slices, key=repr), sorted(counters), sorted(flows.values())


class PerfettoTrace(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "small.yaml").write_text(CONFIG)

    def run_with(self, trace):
        return subprocess.run([os.environ["CAROUSEL"], "run", "small.yaml", "--quiet", "--no-html", "--force", "--out", "out",
                               "--trace", trace], cwd=self.path, capture_output=True, text=True)

    def test_says_what_the_json_says(self):
        done = self.run_with("a.pftrace")
        if "built without protobuf" in done.stderr:
            self.assertEqual(done.returncode, 2)
            self.assertFalse((self.path / "a.pftrace").exists() or (self.path / "out").exists())
            self.skipTest("built without protobuf")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.run_with("a.json").returncode, 0)
        chrome = json.loads((self.path / "a.json").read_text())
        perfetto = of_perfetto((self.path / "a.pftrace").read_bytes())
        for mine, other, what in zip(perfetto, of_chrome(chrome), ("slices", "counters", "flows")):
            self.assertGreater(len(mine), 10, what)
            self.assertEqual(mine, other, what)
        self.assertLess((self.path / "a.pftrace").stat().st_size, (self.path / "a.json").stat().st_size / 2)


if __name__ == "__main__":
    unittest.main()
