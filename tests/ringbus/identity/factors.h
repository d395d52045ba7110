#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/ringbus/support/test_machine.h"

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

/// The values of an enum.
template <class E>
std::vector<E> all(E) {
  std::vector<E> values;
  for (const auto& entry : kEnumNames<E>) values.push_back(entry.value);
  return values;
}

/// Every way a native machine can be arranged that must not show in the hits (DESIGN.md section 3).
inline std::vector<Factor> machine_factors() {
  using I = std::int64_t;
  const std::vector<TopologyShape> shapes{TopologyShape::kRing, TopologyShape::kBidirectional,
                                          TopologyShape::kPointToPoint};
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
      factor("elements", all(BvhConfig::Elements{}), [](Cell& c, BvhConfig::Elements v) { c.config.bvh.elements = v; }),
      factor<I>("mixed", {0, 2}, [](Cell& c, I v) { c.config.bvh.mixed_triangles = v; }),
      factor<I>("workers", {1, 2, 3}, [](Cell& c, I v) { c.config.shading.workers = v; }),
      factor("simd", simd_targets(), [](Cell& c, SimdTarget v) { c.config.engine.simd = v; }),
      factor<std::size_t>("threads", {1, 2, 4}, [](Cell& c, std::size_t v) { c.threads = v; }),
  };
}

/// What only a machine under virtual time can have otherwise; `machine_factors` apart from queues and the
/// placements that need the native engine.
inline std::vector<Factor> cycle_factors() {
  using I = std::int64_t;
  std::vector<Factor> factors = machine_factors();
  std::erase_if(factors, [](const Factor& f) {
    // Of threads there is a test of its own: more than there are cores wait for each other in every window.
    return f.name == "queue" || f.name == "placement" || f.name == "shape" || f.name == "threads";
  });
  const std::vector<Factor> more{
      factor<std::size_t>("threads", {1, 2}, [](Cell& c, std::size_t v) { c.threads = v; }),
      factor<int>("engine", {0}, [](Cell& c, int) { c.config.engine.kind = EngineKind::kCycle; }),
      factor("placement", std::vector{Placement::kBalanced, Placement::kRoundRobin},
             [](Cell& c, Placement v) { c.config.rays.placement = v; }),
      factor("shape",
             std::vector{TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kMultiRing,
                         TopologyShape::kHierarchical, TopologyShape::kPointToPoint, TopologyShape::kBus,
                         TopologyShape::kIndependent},
             [](Cell& c, TopologyShape v) { c.config.topology.shape = v; }),
      factor<I>("groups", {1, 3}, [](Cell& c, I v) { c.config.topology.groups = c.config.topology.rings = v; }),
      factor<I>("contexts", {1, 3}, [](Cell& c, I v) { c.config.testers.contexts = v; }),
      factor("carry", std::vector{PacketCarry::kReference, PacketCarry::kData},
             [](Cell& c, PacketCarry v) { c.config.packets.carry = v; }),
      factor("fetch", std::vector{MemoryConfig::Fetch::kPacket, MemoryConfig::Fetch::kResource},
             [](Cell& c, MemoryConfig::Fetch v) { c.config.memory.fetch = v; }),
      factor<I>("fetch ahead", {0, 2}, [](Cell& c, I v) { c.config.memory.fetch_ahead = v; }),
      factor<I>("hop", {1, 4, 30}, [](Cell& c, I v) { c.config.topology.link.latency_cycles = v; }),
      factor<I>("link width", {4, 64}, [](Cell& c, I v) { c.config.topology.link.bytes_per_cycle = v; }),
      factor<I>("cache", {1, 1024}, [](Cell& c, I v) { c.config.memory.l2_kib = v; }),
      factor<I>("shared by", {1, 4}, [](Cell& c, I v) { c.config.memory.shared_by = v; }),
      factor<bool>("idle shade", {false, true}, [](Cell& c, bool v) { c.config.shading.idle_resources_shade = v; }),
      factor("distribute", all(ShadingConfig::Distribute{}),
             [](Cell& c, ShadingConfig::Distribute v) { c.config.shading.distribute = v; }),
      factor("any hit", std::vector{TestersConfig::AnyHit::kInline, TestersConfig::AnyHit::kShader},
             [](Cell& c, TestersConfig::AnyHit v) { c.config.testers.any_hit = v; }),
      factor<I>("any-hit shade", {0, 10}, [](Cell& c, I v) { c.config.shading.cycles_per_any_hit = v; }),
      factor<I>("shade", {0, 20}, [](Cell& c, I v) { c.config.shading.cycles_per_shade = v; }),
  };
  factors.insert(factors.end(), more.begin(), more.end());
  return factors;
}

}  // namespace carousel::ringbus
