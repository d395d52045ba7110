#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/ringbus/test_machine.h"

namespace carousel::ringbus {

/// One thing a machine can have otherwise, and the ways it can.
struct Factor {
  std::string name;
  std::vector<std::function<void(Cell&)>> levels;
};

template <class T, class Set>
Factor factor(std::string name, const std::vector<T>& values, const Set& set) {
  Factor out{std::move(name), {}};
  for (const T& value : values) out.levels.push_back([value, set](Cell& cell) { set(cell, value); });
  return out;
}

/// Every way a native machine can be arranged that must not show in the hits (DESIGN.md section 3).
inline std::vector<Factor> machine_factors() {
  using I = std::int64_t;
  const auto all = []<class E>(E) {
    std::vector<E> values;
    for (const auto& entry : kEnumNames<E>) values.push_back(entry.value);
    return values;
  };
  const std::vector<TopologyShape> shapes{TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kPointToPoint};
  const std::vector<Flow> flows{Flow::kCredits, Flow::kBubble};
  return {
      factor<I>("resources", {1, 2, 5, 16}, [](Cell& c, I v) { c.config.topology.resources = v; }),
      factor("shape", shapes, [](Cell& c, TopologyShape v) { c.config.topology.shape = v; }),
      factor("visit", all(Visit{}), [](Cell& c, Visit v) { c.config.topology.visit = v; }),
      factor("flow", flows, [](Cell& c, Flow v) { c.config.topology.flow = v; }),
      factor("queue", queue_kinds(), [](Cell& c, QueueKind v) { c.config.topology.link.queue = v; }),
      factor<I>("depth", {1, 2, 16}, [](Cell& c, I v) { c.config.topology.link.depth = v; }),
      factor<I>("slots", {1, 7, 64, 512}, [](Cell& c, I v) { c.config.rays.slots_per_resource = v; }),
      factor("placement", all(Placement{}), [](Cell& c, Placement v) { c.config.rays.placement = v; }),
      factor<I>("packet rays", {1, 5, 32, 128}, [](Cell& c, I v) { c.config.packets.rays = v; }),
      factor("shapes", all(PacketShapes{}), [](Cell& c, PacketShapes v) { c.config.packets.shapes = v; }),
      factor<I>("ready", {1, 16, 300}, [](Cell& c, I v) { c.config.collections.ready = v; }),
      factor("traversal", all(Traversal{}), [](Cell& c, Traversal v) { c.config.collections.traversal = v; }),
      factor("policy", all(Policy{}), [](Cell& c, Policy v) { c.config.collections.policy = v; }),
      factor("select", all(Select{}), [](Cell& c, Select v) { c.config.collections.select = v; }),
      factor("home", all(Home{}), [](Cell& c, Home v) { c.config.collections.home = v; }),
      factor("when_full", all(WhenFull{}), [](Cell& c, WhenFull v) { c.config.collections.when_full = v; }),
      factor<bool>("storage", {false, true}, [](Cell& c, bool v) { c.tight_storage = v; }),
      factor<I>("width", {2, 3, 4, 8}, [](Cell& c, I v) { c.config.bvh.width = v; }),
      factor<I>("leaf", {1, 4, 8, 16}, [](Cell& c, I v) { c.config.bvh.leaf_triangles = v; }),
      factor<I>("treelet", {1, 64, 500, 100000}, [](Cell& c, I v) { c.config.bvh.treelet_triangles = v; }),
      factor<I>("workers", {1, 2, 3}, [](Cell& c, I v) { c.config.shading.workers = v; }),
      factor("simd", simd_targets(), [](Cell& c, SimdTarget v) { c.config.engine.simd = v; }),
      factor<std::size_t>("threads", {1, 2, 4}, [](Cell& c, std::size_t v) { c.threads = v; }),
  };
}

}  // namespace carousel::ringbus
