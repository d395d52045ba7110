#!/usr/bin/env python3
"""Compares networks that are drawn, run alone by `carousel run` (workload: {traffic: ...}), with rows of BookSim2.

    graph_rows.py CAROUSEL [--rows FILE.csv] [--graphs FOLDER_OR_FILE] [--only WORD]... [--part I/N] [--every]
    graph_rows.py --printed FILE... --write docs/internals/validation.md
    graph_rows.py CAROUSEL --model ROUTER_MODEL --seeds N [--only WORD]... [--part I/N]

A graph is FOLDER/NAME.txt with lines `node I`, `router I`, `link A B LATENCY`, `arc A B LATENCY`; or all of them stand
in one file, each behind a line `graph NAME ...` (tests/data/booksim2_graphs.txt). A row is graph, flits, offered, vcs,
vc_buffer, speculative, mean_packet_latency, accepted_rate, status. Compared are:
  - at hardly any load (status drained), the latency with the closed form at the ways that were drawn, within 0.1 %;
  - at half of the bound of the busiest link or less, and no more than a tenth more (status keeps_up), the latency within 3 %;
  - where more is offered than gets through (status saturated), the rate within 1 %.
Rows between are shown with --every, and judged by none. Rows of networks without virtual channels are those with
speculation (the others of one channel pass a packet every other cycle). Ends with status 1 if a row is missed.
--model compares rows where more is offered than gets through with tests/validation/router_model.cpp: the mean of N
seeds with its mean of N seeds, within 1 % or four standard errors. Each mean has the standard deviation of one seed
behind it. The last number is how many of these the row, of one seed, is off.
--printed reads what runs have printed, and --write puts a table of it into a page, between its marks."""
import argparse
import csv
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

MARKS = "<!-- graph_rows.py begins -->\n", "<!-- graph_rows.py ends -->\n"
FLIT = 32  # bytes
LIMITS = {"alone": 0.1, "latency": 3.0, "accepted": 1.0}  # per cent
DATA = Path(__file__).resolve().parents[1] / "data"
CYCLES = 15000  # of warm-up, and as many that are measured


def read_graphs(path):
    """Links of each graph by name: kind, from, to, latency; and how many nodes and routers it has."""
    graphs = {}
    files = sorted(path.glob("*.txt")) if path.is_dir() else [path]
    for file in files:
        name = file.stem
        for line in file.read_text().splitlines():
            words = line.split("#")[0].split()
            if not words:
                continue
            if words[0] == "graph":
                name = words[1]
                graphs[name] = {"nodes": int(words[2]), "routers": int(words[3]), "links": []}
                continue
            graph = graphs.setdefault(name, {"nodes": 0, "routers": 0, "links": []})
            if words[0] == "node":
                graph["nodes"] += 1
            elif words[0] == "router":
                graph["routers"] += 1
            else:
                graph["links"].append((words[0], *map(int, words[1:4])))
    return graphs


def drawn(graph, row, rate, packets):
    """The same network: BookSim2's router takes a cycle to give a packet a channel, one for its way through the switch
    and one for that way; a place is known to be free a cycle after it is."""
    speculative, channels, flits = row["speculative"] == "1", int(row["vcs"]), int(row["flits"])
    node = 2 if speculative else 3
    keys = {"latency_cycles": node, "credit_cycles": 1, "claim_cycles": 0 if speculative else 1}

    def name(i):
        return f"r[{i}]" if i < graph["nodes"] else f"x[{i - graph['nodes']}]"
    nodes = [{"name": "r", "count": graph["nodes"], **keys}]
    if graph["routers"]:
        nodes.append({"name": "x", "kind": "router", "count": graph["routers"], **keys})
    links = [{"from": name(a), "to": name(b), "latency_cycles": latency, "both": kind == "link"}
             for kind, a, b, latency in graph["links"]]
    return {"engine": {"kind": "cycle"},
            "topology": {"shape": "graph", "nodes": nodes, "links": links,
                         "link": {"virtual_channels": channels, "depth": int(row["vc_buffer"]) // flits}},
            "workload": {"traffic": {"inject_cycles": node, "eject_cycles": 3, "rate": rate / flits, "packets": packets,
                                     "packet_bytes": FLIT * flits,
                                     "warmup_fraction": 0.0 if row["status"] == "drained" else 0.5}}}


def simulate(carousel, graph, row, folder, seed):
    """Latency, flits accepted a node and cycle, and the closed form at the ways that were drawn."""
    offered, flits = float(row["offered"]), int(row["flits"])
    packets = 6000 if row["status"] == "drained" else round(offered * graph["nodes"] * 2 * CYCLES / flits)
    if row["status"] == "drained":
        offered = 0.0003
    config = drawn(graph, row, offered, packets)
    config["image"] = {"seed": seed}
    (folder / "graph.yaml").write_text(json.dumps(config))
    done = subprocess.run([carousel, "run", folder / "graph.yaml", "--out", folder / "out", "--force", "--quiet",
                           "--no-html"], capture_output=True, text=True)
    if done.returncode != 0:
        return None
    return json.loads((folder / "out/report.json").read_text())["traffic"]


def modelled(model, graph, row, seed):
    """Flits accepted a node and cycle, by the model. A way back that is not drawn has a latency of 1000, as the rows'."""
    links = {(a, b): latency for kind, a, b, latency in graph["links"]}
    for kind, a, b, latency in graph["links"]:
        links.setdefault((b, a), latency if kind == "link" else 1000)
    text = f"{graph['nodes']} {graph['routers']}\n" + "".join(f"{a} {b} {links[a, b]}\n" for a, b in sorted(links))
    words = [row[key] for key in ("offered", "flits", "vcs", "vc_buffer", "speculative")]
    return float(subprocess.run([model, *words, str(seed)], input=text, capture_output=True, text=True, check=True).stdout)


def against_model(carousel, model, graph, row, folder, seeds):
    """A printed row, and whether the means agree."""
    runs = [simulate(carousel, graph, row, folder, seed) for seed in range(1, seeds + 1)]
    router = f"{row['vcs']} of {row['vc_buffer']}" + (", speculative" if row["speculative"] == "1" else "")
    begin = f"| {row['graph']} | {row['flits']} | {float(row['offered']):g} | {router} |"
    if None in runs:
        return f"{begin} stopped |", True
    ours = [run["accepted"] * int(row["flits"]) for run in runs]
    second = [modelled(model, graph, row, seed) for seed in range(1, seeds + 1)]
    means = [statistics.mean(ours), statistics.mean(second)]
    spreads = [statistics.stdev(ours), statistics.stdev(second)]
    theirs = float(row["accepted_rate"])
    off = means[0] - means[1]
    spread = max(statistics.mean(spreads), 1e-9)
    agrees = abs(off) <= max(0.01 * means[1], 4 * spread * (2 / seeds) ** 0.5)
    cells = [f"{theirs:.5f}"] + [f"{mean:.5f} ± {100 * sd / mean:.2f} %" for mean, sd in zip(means, spreads)]
    cells += [f"{100 * off / means[1]:+.2f} %", f"{(theirs - statistics.mean(means)) / spread:+.1f}"]
    return f"{begin} {' | '.join(cells)} |" + ("" if agrees else " missed"), agrees


def judged(row, bound):
    """What a row is compared in: closed form, latency, rate, or nothing."""
    if row["status"] == "drained":
        return "alone"
    if row["status"] == "saturated":
        return "accepted"
    return "latency" if row["status"] == "keeps_up" and float(row["offered"]) <= 0.55 * bound else ""


def compare(carousel, graph, row, kind, folder, seeds):
    """Theirs, ours and the difference in per cent; ours is None where our network stopped."""
    flits = int(row["flits"])
    runs = [simulate(carousel, graph, row, folder, seed) for seed in range(1, seeds + 1)]
    if None in runs:
        return None, None, None
    if kind == "alone":
        theirs, ours = runs[0]["zero_load_latency"], runs[0]["latency"]["mean"]
    elif row["status"] == "saturated":
        theirs = float(row["accepted_rate"])
        ours = statistics.mean(run["accepted"] * flits for run in runs)
    else:
        theirs = float(row["mean_packet_latency"])
        ours = statistics.mean(run["latency"]["mean"] for run in runs)
    return theirs, ours, 100 * (ours / theirs - 1)


def summary(lines):
    """A table of printed rows by router, flits and what is compared, and the rows that are missed."""
    groups, missed = {}, []
    for line in lines:
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) < 10 or cells[1] == "graph":
            continue
        graph, flits, offered, router, what, theirs, ours, off = cells[1:9]
        if theirs == "stopped":
            missed.append(f"{graph}, {flits} flits at {offered}, {router}: stopped")
            continue
        off = float(off.split()[0])
        groups.setdefault((router, flits, what), []).append(off)
        if cells[9] == "missed":
            missed.append(f"{graph}, {flits} flits at {offered}, {router}: {what} {theirs}, here {ours}, {off:+.2f} %")
    table = ["| channels | flits | compared | rows | goal | median | least | greatest | beyond the goal |",
             "|---|---:|---|---:|---:|---:|---:|---:|---:|"]
    for (router, flits, what), offs in sorted(groups.items()):
        beyond = sum(abs(off) > LIMITS[what] for off in offs)
        table.append(f"| {router} | {flits} | {what} | {len(offs)} | {LIMITS[what]:g} % | {statistics.median(offs):+.2f} % | "
                     f"{min(offs):+.2f} % | {max(offs):+.2f} % | {beyond} |")
    return "\n".join(table + [""] + [f"- {one}" for one in missed]) + "\n"


def write(text, page):
    print(text, end="")
    if page is None:
        return
    old = page.read_text()
    begin, end = old.index(MARKS[0]) + len(MARKS[0]), old.index(MARKS[1])
    page.write_text(old[:begin] + text + old[end:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("carousel", type=Path, nargs="?")
    parser.add_argument("--rows", type=Path, default=DATA / "booksim2_graph_rows.csv")
    parser.add_argument("--graphs", type=Path, default=DATA / "booksim2_graphs.txt")
    parser.add_argument("--only", action="append", default=[], help="rows that have the word, as graph or key=value")
    parser.add_argument("--every", action="store_true", help="show rows that are not judged as well")
    parser.add_argument("--seeds", type=int, default=1, help="runs of each row, whose mean is compared")
    parser.add_argument("--model", type=Path, help="the program of tests/validation/router_model.cpp")
    parser.add_argument("--part", default="0/1", help="I/N: every Nth row from the Ith")
    parser.add_argument("--printed", type=Path, nargs="+")
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    if arguments.model and arguments.seeds < 2:
        parser.error("--model needs --seeds 2 or more")
    if arguments.printed:
        write(summary(line for file in arguments.printed for line in file.read_text().splitlines()), arguments.write)
        return 0
    graphs = read_graphs(arguments.graphs)
    part, parts = map(int, arguments.part.split("/"))
    with arguments.rows.open() as file:
        rows = list(csv.DictReader(file))
    lines, missed, count = [], 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for row in rows:
            graph, bound = graphs[row["graph"]], float(row["bound"])
            kind = judged(row, bound)
            wanted = all(row[word.split("=")[0]] == word.split("=")[1] if "=" in word else row["graph"] == word
                         for word in arguments.only)
            if not wanted or row["status"] in ("deadlock", "stalling") or not (kind or arguments.every):
                continue
            if row["vcs"] == "1" and row["speculative"] == "0":
                continue
            count += 1
            if count % parts != part:
                continue
            if arguments.model:
                if row["status"] == "saturated":
                    line, agrees = against_model(arguments.carousel, arguments.model, graph, row, Path(folder),
                                                 arguments.seeds)
                    lines.append(line)
                    missed += not agrees
                    print(line, flush=True)
                continue
            theirs, ours, off = compare(arguments.carousel, graph, row, kind, Path(folder), arguments.seeds)
            bad = kind and (off is None or abs(off) > LIMITS[kind])
            missed += bool(bad)
            what = {"alone": "alone", "accepted": "accepted"}.get(kind, "latency")
            if not kind and row["status"] == "saturated":
                what = "accepted"
            numbers = "stopped | | " if off is None else f"{theirs:.5g} | {ours:.5g} | {off:+.2f} %"
            router = f"{row['vcs']} of {row['vc_buffer']}" + (", speculative" if row["speculative"] == "1" else "")
            lines.append(f"| {row['graph']} | {row['flits']} | {float(row['offered']):g} | {router} | {what} | {numbers} |"
                         + ("" if not bad else " missed"))
            print(lines[-1], flush=True)
    print(f"{len(lines)} rows, {missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
