#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/accuracy/accuracy_table.h"
#include "report/read/document.h"
#include "report/run/report_json.h"
#include "tests/report/run/sample_report.h"

namespace carousel::report {

/// A document of each kind, small, with every part that a reader looks at, and not sealed.
struct SampleDocument {
  const char* name;
  DocumentKind kind;
  nlohmann::ordered_json json;
};

inline Report timed_report() {
  Report r = sample_report();
  r.engine.kind = "cycle";
  r.engine.cycles = 4000;
  r.engine.epochs = Epochs{1000, {"01", "02", "03", "04"}};
  for (Resource& resource : *r.resources) resource.units.emplace();
  for (Link& link : *r.links) {
    link.utilisation = 0.25;
    link.cycles = LinkCycles{1000, 10, 2990};
  }
  r.ranks = {{0, 0, 1, 2, 100, 0.5}, {1, 1, 1, 2, 200, 0.25}};
  r.rank_links = std::vector<RankLink>(2);
  r.rank_links->at(0).to = 1;
  r.rank_links->at(1).from = 1;
  r.rank_links->at(1).held = 0.125;
  r.bytes = {{"packets", "resource", "resource", "links", 16, 12345, 100}};
  r.time_series = TimeSeries{"cycles",
                             500,
                             4,
                             {{"machine", "rays", "rays/cycle", "mean", {1, 2, 3, 4}},
                              {"resource 0", "busy", "fraction", "mean", {0.5, 0.25, 0.125, 1}}}};
  r.sampled.emplace().uses = {{"box", {0.5, 0.25, 0.75}}};
  r.bound = {12.5, 0.5, {{"links", 25}}};
  r.bottleneck.emplace().limits = "links";
  r.bottleneck->rivals = {"box_units"};
  r.bottleneck->gains = {{"links", "wider links", {"topology.link.bytes_per_cycle=32"}, 14, 0.125, 0.0625, 0.25}};
  r.energy = {"n7", 1e-6, 2, 3, 4, {}};
  r.area = {12.5, 3, 0.5, {}};
  r.costs = {{"box", "pJ", "assumed", "a source", 1.5}};
  return r;
}

inline Accuracy sample_accuracy() {
  Accuracy a;
  a.scene = "cornell";
  a.rays = 100;
  a.repetitions = 3;
  a.hard = {{"slivers", "thin triangles", false, true}};
  AccuracyRow row;
  row.triangle = row.box = row.transform = "exact";
  row.ns_per_ray = {100, 90, 120};
  row.modelled.emplace().cycles_per_ray = 10;
  row.modelled->tester_limited = TesterLimited{5, "box", 0.5};
  row.scene.rays = 100;
  row.hard.emplace_back().rays = 10;
  a.rows = {row, row};
  a.spawn = {{"bound", 10, 0, 20, 0, {}}};
  a.sampling = {{1, 0.5, 0.25}, {2, 0.25, 0.5}};
  a.verdict = "exact is safe";
  a.recommended[0] = 1;
  return a;
}

inline Stress sample_stress() {
  Stress s;
  s.cores = 2;
  s.repetitions = 3;
  StressRow& row = s.rows.emplace_back();
  row.queue = "spsc_ring";
  row.pattern = "one_to_one";
  row.message_bytes = 64;
  row.rate_median = 1e6;
  row.transit = StressLatency{1, 2, 3, 4};
  StressRingRow& ring = s.ring.emplace_back();
  ring.queue = "spsc_ring";
  ring.depth = 4;
  s.ring_pairs = StressPairs{{"spsc_ring", 4}, {"mutex", 4}, 8, 6};
  s.ring_verdict = "spsc_ring is faster";
  return s;
}

inline RayLife sample_life() {
  RayLife life;
  life.engine = "cycle";
  life.unit = "cycles";
  life.ray.kind = "camera";
  life.latency = 100;
  life.stages = {{"tested", 60, 0.6, 2}, {"waiting", 40, 0.4, 1}};
  life.spans = {{0, 60, "tested", "resource 0", 3, "7"}, {60, 40, "waiting", "", {}, {}}};
  RayTest& test = life.tests.emplace_back();
  test.node = "7";
  test.shapes = 4;
  test.found = RayHit{1.5, 0, 2};
  life.caused = {life.ray};
  return life;
}

inline nlohmann::ordered_json sample_sweep() {
  return nlohmann::ordered_json::parse(R"({"schema_version": 2, "carousel": {"version": "1", "commit": "a"},
    "config": "a.yaml", "keys": ["topology.resources"], "results": ["cycles", "gain"], "greater_is_better": ["gain"],
    "points": [
      {"point": "0a", "status": "done", "keys": {"topology.resources": 2}, "results": {"cycles": 100, "gain": 0.5},
       "host_seconds": 0.5},
      {"point": "0b", "status": "done", "keys": {"topology.resources": 4}, "results": {"cycles": 60, "gain": null},
       "host_seconds": 0.25},
      {"point": "0c", "status": "failed", "keys": {"topology.resources": 8}, "results": {},
       "error": {"kind": "config", "text": "no"}, "host_seconds": 0}],
    "pareto": {"goals": [{"result": "cycles", "maximise": false}, {"result": "gain", "maximise": true}],
               "points": ["0a"]},
    "main_effects": [{"key": "topology.resources", "result": "cycles", "mean": 80, "levels": [
      {"level": 2, "points": 1, "effect": 20, "low": 10, "high": 30}, {"level": 4, "points": 1, "effect": -20}]}]})");
}

inline std::vector<SampleDocument> sample_documents() {
  nlohmann::ordered_json point{{"schema_version", 2},
                               {"point", "0a"},
                               {"status", "done"},
                               {"keys", {{"topology.resources", 2}}},
                               {"sets", {"topology.resources=2"}},
                               {"host", {{"seconds", 0.5}}},
                               {"report", report_json(sample_report())}};
  return {{"run of the cycle engine", DocumentKind::kRun, report_json(timed_report())},
          {"run of the native engine", DocumentKind::kRun, report_json(sample_report())},
          {"sweep", DocumentKind::kSweep, sample_sweep()},
          {"point", DocumentKind::kPoint, std::move(point)},
          {"accuracy", DocumentKind::kAccuracy, accuracy_json(sample_accuracy())},
          {"stress", DocumentKind::kStress, stress_json(sample_stress())},
          {"ray", DocumentKind::kRayLife, ray_life_json(sample_life())}};
}

}  // namespace carousel::report
