#pragma once

#include <string>
#include <vector>

#include "tests/app/keys/key_row.h"

namespace carousel {

/// A ring of four whose stops have no queues.
inline constexpr const char* kStopsRing =
    "topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]', both: true, stops: {rule: slots}}]}";

/// The links of such a ring.
inline std::string ring_of_slots(const std::string& key) {
  return "[{ring: 'r[*]', both: true, stops: {rule: slots, " + key + "}}]";
}
inline std::string ring_of_grants(const std::string& key) {
  return "[{ring: 'r[*]', both: true, stops: {rule: grants, " + key + "}}]";
}

/// The rows of the keys of a network.
inline std::vector<KeyRow> network_key_rows() {
  using enum BaseMachine;
  return {
      {"topology.resources", kTerrain, {}, {"3"}},
      {"topology.shape",
       kTerrain,
       {"topology.visit=owners"},
       {"bidirectional", "multi_ring", "hierarchical", "point_to_point", "bus", "independent"}},
      {"topology.shape",
       kTerrain,
       {"topology.shape=ring", "topology.resources=1", "testers.simd.lanes=8"},
       {"central"}},
      {"topology.shape",
       kTerrain,
       {"topology.visit=owners", "topology.nodes=[{name: r, count: 4}]", "topology.links=[{mesh: [2, 2]}]"},
       {"graph"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}"},
       {"[{name: r, count: 3}]", "[{name: r, count: 4, latency_cycles: 9}]"}},
      {"topology.links",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}"},
       {"[{ring: 'r[*]', latency_cycles: 9}]", "[{ring: 'r[*]', bytes_per_cycle: 8}]", "[{ring: 'r[*]', depth: 1}]",
        "[{ring: 'r[*]', both: true}]", "[{mesh: [2, 2]}]", "[{ring: 'r[*]', lanes: 2}]",
        "[{ring: 'r[*]', lane: 0}, {ring: 'r[3..0]', lane: 1}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: b, kind: router}], "
        "links: [{from: 'r[*]', to: b, both: true}]}"},
       {"[{name: r, count: 4}, {name: b, kind: bus}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}", "testers.simd.lanes=8"},
       {"[{name: r, count: 4, kind: packet_process}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: a, kind: cache, count: 2, serves: 'r[0..2]'}, "
        "{name: b, kind: cache, serves: 'r[3]'}, {name: d, kind: memory}], links: [{ring: 'r[*]'}, "
        "{from: 'r[*]', all_to: 'a[*], b', both: true, carries: [shapes]}, "
        "{from: 'a[*], b', to: d, both: true, carries: [shapes]}]}"},
       {"[{name: r, count: 4}, {name: a, kind: cache, count: 2, serves: 'r[0..2]', interleave_bytes: 1024}, "
        "{name: b, kind: cache, serves: 'r[3]'}, {name: d, kind: memory}]",
        "[{name: r, count: 4}, {name: a, kind: cache, count: 2, serves: 'r[0..1]'}, "
        "{name: b, kind: cache, serves: 'r[2..3]'}, {name: d, kind: memory}]"}},
      {"topology.links",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: l2, kind: cache}, {name: s, kind: shading}], "
        "links: [{ring: 'r[*]'}, {from: 'r[*]', to: l2, both: true, carries: [shapes]}, "
        "{from: 'r[*]', to: s, both: true, carries: [new_rays]}]}"},
       {"[{ring: 'r[*]'}, {from: 'r[*]', to: l2, both: true, carries: [shapes]}, "
        "{from: 'r[*]', to: s, both: true, carries: [new_rays, completed_rays]}]",
        "[{ring: 'r[*]', carries: [packets, shapes]}, {line: 'r[0], l2', both: true, carries: [shapes]}, "
        "{from: 'r[*]', to: s, both: true, carries: [new_rays]}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: a, kind: shading, serves: 'r[0..1]'}, "
        "{name: b, kind: shading}], links: [{ring: 'r[*]'}, "
        "{from: 'r[*]', all_to: 'a, b', both: true, carries: [new_rays, completed_rays]}]}"},
       {"[{name: r, count: 4}, {name: a, kind: shading, serves: 'r[0..1]', workers: 1}, {name: b, kind: shading}]",
        "[{name: r, count: 4}, {name: a, kind: shading, serves: 'r[0..2]'}, {name: b, kind: shading}]"}},
      {"topology.routes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 5}], links: [{ring: 'r[*]', both: true}]}",
        "topology.routes=shortest"},
       {"up_down"}},
      {"topology.routes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 5}], links: [{ring: 'r[*]', both: true}], "
        "ways: [{along: 'r[0], r[4], r[3], r[2], r[1]'}]}",
        "topology.routes=shortest"},
       {"given"}},
      {"topology.root",
       kTerrain,
       {"topology={shape: graph, routes: up_down, nodes: [{name: r, count: 5}], links: [{ring: 'r[*]', both: true}]}"},
       {"r[2]"}},
      {"topology.ways",
       kTerrain,
       {"topology={shape: graph, routes: given, nodes: [{name: r, count: 5}], links: [{ring: 'r[*]', both: true}]}"},
       {"[{along: 'r[0], r[4], r[3], r[2], r[1]'}]",
        "[{at: 'r[3]', to: 'r[0]', next: 'r[2]'}, {at: 'r[2]', to: 'r[0]', next: 'r[1]'}]"}},
      {"topology.tour",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[0], r[2], r[1], r[3]', both: true}]}",
        "topology.tour=names"},
       {"nearest"}},
      {"topology.trace",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r}]}", "topology.trace=packets"},
       {"stacks"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, trace: stacks, nodes: [{name: r, count: 4}]}"},
       {"[{name: r, count: 3}]"}},
      {"topology.link.virtual_channels",
       kTraffic,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{line: 'r[*]', both: true}]}",
        "workload.traffic.rate=0.8"},
       {"4"}},
      {"topology.channels",
       kTraffic,
       {"topology={shape: graph, link: {virtual_channels: 4}, nodes: [{name: r, count: 4}], links: [{line: 'r[*]', "
        "both: true}]}",
        "topology.channels=any", "workload.traffic.rate=0.8"},
       {"hops"}},
      {"topology.channels",
       kTraffic,
       {"topology={shape: graph, link: {virtual_channels: 4}, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]', "
        "both: true}]}",
        "topology.channels=hops", "workload.traffic.rate=0.8"},
       {"dateline"}},
      {"topology.channels",
       kTraffic,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{from: 'r[*]', all_to: 'r[*]'}]}",
        "topology.channels=any", "workload.traffic.rate=0.8"},
       {"none"}},
      {"topology.flow",
       kTraffic,
       {"topology={shape: graph, channels: none, link: {depth: 2}, nodes: [{name: r, count: 4}], links: [{ring: "
        "'r[*]'}]}",
        "workload.traffic.rate=0.8"}},
      {"topology.links",
       kTraffic,
       {kStopsRing, "workload.traffic.packet_bytes=128", "workload.traffic.rate=0.9"},
       {ring_of_slots("rings: 2"), ring_of_slots("port_bytes_per_cycle: 8"), ring_of_slots("fair_after_cycles: 1"),
        ring_of_grants("grant_cycles: 1"), ring_of_grants("grant_cycles: 40"), ring_of_grants("command_cycles: 9"),
        ring_of_grants("start_cycles: 99"), ring_of_grants("transfers: 1")}},
      {"topology.rings", kTerrain, {"topology.shape=multi_ring"}, {"3"}},
      {"topology.groups",
       kTraffic,
       {"topology={shape: hierarchical, resources: 8, link: {virtual_channels: 4}, channels: dateline}"},
       {"2"}},
      {"topology.groups", kTerrain, {"topology.shape=hierarchical"}, {"2"}},
      {"topology.form", kTerrain, {"topology.shape=central", "topology.resources=1", "testers.contexts=4"}},
      {"topology.visit", kTerrain},
      {"topology.flow", kTerrain, {"topology.link.depth=2"}},
      {"topology.link.queue", kNative},
      {"topology.link.depth", kTerrain, {}, {"1"}},
      {"topology.link.latency_cycles", kTerrain, {}, {"9"}},
      {"topology.link.bytes_per_cycle", kTerrain, {}, {"8"}},
      {"topology.links",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: x, kind: router, clock: slow}], links: [{ring: "
        "'r[*], x'}]}",
        "clocks={slow: 700}"},
       {"[{ring: 'r[*], x', clock: slow}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: x, kind: router}], links: [{ring: 'r[*], x', "
        "clock: slow}]}",
        "clocks={slow: 700}"},
       {"[{name: r, count: 4}, {name: x, kind: router, clock: slow}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}, {name: l2, kind: cache}, {name: d, kind: memory}], "
        "links: "
        "[{ring: 'r[*]'}, {from: 'r[*]', to: l2, both: true, carries: [shapes]}, {from: l2, to: d, both: true, clock: "
        "slow, carries: [shapes]}]}",
        "clocks={slow: 700}"},
       {"[{name: r, count: 4}, {name: l2, kind: cache}, {name: d, kind: memory, clock: slow}]"}},
      {"topology.nodes",
       kTraffic,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{line: 'r[*]', both: true, clock: slow}]}",
        "clocks={slow: 700}"},
       {"[{name: r, count: 4, clock: slow}]"}},
      {"topology.nodes",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 3}, {name: q}], links: [{ring: 'r[*], q'}]}"},
       {"[{name: r, count: 3}, {name: q, slots_per_resource: 8}]", "[{name: r, count: 3}, {name: q, ready: 2}]",
        "[{name: r, count: 3}, {name: q, testers: {box: {units: 1, interval_cycles: 9}}}]"}},
      {"topology.overrides", kTerrain, {}, {"[{resource: 1, testers: {box: {units: 1, interval_cycles: 9}}}]"}},
      {"topology.overrides",
       kTerrain,
       {"memory.l1_kib=4", "memory.l1_ways=4", "collections.partial=after"},
       {"[{resource: 1, slots_per_resource: 8}]", "[{resource: 1, reads_per_cycle: 1}]",
        "[{resource: 1, ids_per_cycle: 1}]", "[{resource: 1, ready: 2}]", "[{resource: 1, sort_ids_per_cycle: 1}]",
        "[{resource: 1, partial_after_cycles: 9}]", "[{resource: 1, fetch_ahead: 0}]",
        "[{resource: 1, shape_buffer_kib: 4}]", "[{resource: 1, l1_kib: 1}]", "[{resource: 1, l1_ways: 1}]",
        "[{resource: 1, l1_latency_cycles: 90}]", "[{resource: 1, l1_mshrs: 1}]",
        "[{resource: 1, testers: {contexts: 1}}]"}},
      {"topology.overrides",
       kTerrain,
       {"memory.l1_kib=4", "memory.l1_lines_per_cycle=1"},
       {"[{resource: 1, l1_lines_per_cycle: 64}]"}},
      {"topology.overrides", kTerrain, {"collections.when_full=spill"}, {"[{resource: 1, capacity: 8}]"}},
      {"topology.overrides",
       kTerrain,
       {"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}"},
       {"[{nodes: 'r[1..2]', testers: {box: {units: 1, interval_cycles: 9}}}]",
        "[{nodes: 'r[1..2]', shape_buffer_kib: 4}]"}},
  };
}

}  // namespace carousel
