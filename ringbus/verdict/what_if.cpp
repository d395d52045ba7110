#include "ringbus/verdict/what_if.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/differences.h"
#include "core/config/key_conditions.h"
#include "core/config/load/load.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "ringbus/results/run_features.h"

namespace carousel::ringbus {

namespace {

std::int64_t halved(std::int64_t cycles) {
  return std::max<std::int64_t>(1, cycles / 2);
}

bool uses_links(const Config& c) {
  return in_use(c, {}, "topology.link.depth");
}
constexpr bool every_machine(const Config&) {
  return true;
}

/// Calls `body` with the testers of the whole machine and with those of each resource that differs.
template <class Body>
void for_all_testers(Config& c, const Body& body) {
  body(c.testers);
  for (ResourceOverride& one : c.topology.overrides) body(one.testers);
}

/// A class of parts other than test units.
struct PartClass {
  const char *name, *action;
  bool (*present)(const Config&);  ///< a machine whose keys say so; whether it feels them is core/config's to say
  void (*relax)(Config&);
  int times = 6;              ///< how often tester_limited() relaxes it; 0: it is part of the test, or a choice
  bool keeps_shapes = false;  // as WhatIf's
};
constexpr int kStorageTimes = 2;  // the host has to store it too
constexpr PartClass kPartClasses[] = {
    {"test_latency", "half testers.*.latency_cycles", every_machine,
     [](Config& c) {
       for_all_testers(c, [](TestersConfig& testers) {
         for (auto [kind, units] : testers.units) units.latency_cycles = halved(units.latency_cycles);
       });
     },
     0},
    {"contexts", "twice testers.contexts", every_machine,
     [](Config& c) { for_all_testers(c, [](TestersConfig& testers) { testers.contexts *= 2; }); }},
    {"ray_reads", "twice rays.reads_per_cycle", every_machine, [](Config& c) { c.rays.reads_per_cycle *= 2; }},
    {"ray_banks", "twice rays.banks", every_machine, [](Config& c) { c.rays.banks *= 2; }},
    {"cells", "twice testers.simd.lanes", has_cells,
     [](Config& c) { for_all_testers(c, [](TestersConfig& testers) { testers.simd.lanes *= 2; }); }},
    {"distributed_testers", "twice testers.distributor.testers", every_machine,
     [](Config& c) { c.testers.distributor.testers *= 2; }},
    {"handing_out", "twice testers.distributor.ids_per_cycle", every_machine,
     [](Config& c) { c.testers.distributor.ids_per_cycle *= 2; }},
    {"tester_queues", "twice testers.distributor.queue and results", every_machine,
     [](Config& c) { c.testers.distributor.queue *= 2, c.testers.distributor.results *= 2; }},
    {"out_of_order", "twice testers.distributor.out_of_order, or 1", every_machine,
     [](Config& c) {
       c.testers.distributor.out_of_order = std::max<std::int64_t>(1, 2 * c.testers.distributor.out_of_order);
     }},
    {"decision_point", "twice testers.distributor.results_per_cycle", every_machine,
     [](Config& c) { c.testers.distributor.results_per_cycle *= 2; }},
    {"stragglers", "testers.distributor.stragglers: forward", every_machine,
     [](Config& c) { c.testers.distributor.stragglers = TestersConfig::Distributor::Stragglers::kForward; }, 0},
    {"bundle_builder", "twice bundles.builder.rays_per_cycle", every_machine,
     [](Config& c) { c.bundles.builder.rays_per_cycle *= 2; }},
    {"bundles_open", "twice bundles.builder.open", every_machine, [](Config& c) { c.bundles.builder.open *= 2; }},
    {"dispatch", "twice packets.ids_per_cycle", every_machine, [](Config& c) { c.packets.ids_per_cycle *= 2; }},
    {"sorting", "twice collections.sort_ids_per_cycle", every_machine,
     [](Config& c) { c.collections.sort_ids_per_cycle *= 2; }},
    {"collection_storage", "twice collections.capacity", every_machine, [](Config& c) { c.collections.capacity *= 2; },
     kStorageTimes},
    {"issue_rule", "collections.partial: ahead", every_machine,
     [](Config& c) { c.collections.partial = Partial::kAhead; }, 0},
    {"issue_rule", "collections.partial: idle",
     [](const Config& c) { return c.collections.partial == Partial::kAhead; },
     [](Config& c) { c.collections.partial = Partial::kIdle; }, 0},
    {"shape_buffer", "twice memory.shape_buffer_kib", every_machine, [](Config& c) { c.memory.shape_buffer_kib *= 2; },
     6, true},
    {"fetch_ahead", "twice memory.fetch_ahead", every_machine,
     [](Config& c) { c.memory.fetch_ahead = std::max<std::int64_t>(1, 2 * c.memory.fetch_ahead); }},
    {"l2_size", "twice memory.l2_kib", every_machine, [](Config& c) { c.memory.l2_kib *= 2; }, 6, true},
    {"l2_port", "twice memory.l2_lines_per_cycle", every_machine, [](Config& c) { c.memory.l2_lines_per_cycle *= 2; }},
    {"l1_size", "twice memory.l1_kib", every_machine, [](Config& c) { c.memory.l1_kib *= 2; }, 6, true},
    {"l1_port", "twice memory.l1_lines_per_cycle", every_machine, [](Config& c) { c.memory.l1_lines_per_cycle *= 2; }},
    {"l1_mshrs", "twice memory.l1_mshrs", every_machine, [](Config& c) { c.memory.l1_mshrs *= 2; }},
    {"l2_mshrs", "twice memory.l2_mshrs", every_machine, [](Config& c) { c.memory.l2_mshrs *= 2; }},
    {"memory_latency", "half memory.l2_latency_cycles and memory.dram_latency_cycles", every_machine,
     [](Config& c) {
       c.memory.l2_latency_cycles = halved(c.memory.l2_latency_cycles);
       c.memory.dram_latency_cycles = halved(c.memory.dram_latency_cycles);
     }},
    {"memory_bandwidth", "twice memory.dram_bytes_per_cycle", every_machine,
     [](Config& c) { c.memory.dram_bytes_per_cycle *= 2; }},
    {"memory_bandwidth", "twice memory.dram.channels", every_machine, [](Config& c) { c.memory.dram.channels *= 2; }},
    {"dram_queue", "twice memory.dram.queue", every_machine, [](Config& c) { c.memory.dram.queue *= 2; }},
    {"ray_slots", "twice rays.slots_per_resource", every_machine, [](Config& c) { c.rays.slots_per_resource *= 2; },
     kStorageTimes},
    {"shading", "twice shading.workers", every_machine, [](Config& c) { c.shading.workers = 2 * shader_workers(c); }},
    {"shading_lanes", "twice shading.lanes", [](const Config& c) { return c.shading.lanes > 1; },
     [](Config& c) { c.shading.lanes *= 2; }},
    {"shading_order", "shading.sort: shader", [](const Config& c) { return c.shading.lanes > 1; },
     [](Config& c) { c.shading.sort = ShadingConfig::Sort::kShader; }, 0},
    {"shading_sorter", "twice shading.sort_rays_per_cycle", every_machine,
     [](Config& c) { c.shading.sort_rays_per_cycle *= 2; }},
    {"link_bandwidth", "twice topology.link.bytes_per_cycle", uses_links,
     [](Config& c) { c.topology.link.bytes_per_cycle *= 2; }},
    {"link_latency", "half topology.link.latency_cycles",
     [](const Config& c) { return uses_links(c) && c.topology.link.latency_cycles > 1; },
     [](Config& c) { c.topology.link.latency_cycles = halved(c.topology.link.latency_cycles); }},
    {"packets_in_flight", "twice topology.link.depth", uses_links, [](Config& c) { c.topology.link.depth *= 2; }},
    {"rings", "twice topology.rings",
     [](const Config& c) { return uses_links(c) && c.topology.shape == TopologyShape::kMultiRing; },
     [](Config& c) { c.topology.rings *= 2; }, 0},
    {"ring_directions", "topology.shape: bidirectional",
     [](const Config& c) { return uses_links(c) && c.topology.shape == TopologyShape::kRing; },
     [](Config& c) { c.topology.shape = TopologyShape::kBidirectional; }, 0},
};

/// The keys that the relaxed machine has otherwise, as values of --set; none if the machine feels none of them.
std::vector<std::string> felt_differences(const Config& config, const SceneFacts& scene, const Config& relaxed) {
  Config simulated = config;
  simulated.engine.kind = EngineKind::kCycle;  // a machine that was given for the native engine is simulated here, too
  std::vector<std::string> sets = config_differences(config, relaxed);
  const bool felt = std::any_of(sets.begin(), sets.end(), [&](const std::string& set) {
    const std::string_view key = std::string_view(set).substr(0, set.find('='));
    return key != "topology.overrides" && in_use(simulated, scene, key);  // overrides repeat what `testers` has
  });
  if (!felt) sets.clear();
  return sets;
}

/// Reads the configuration as a user's who tries the what-if. Returns whether it may be run.
bool may_be_set(const std::string& resolved, const std::vector<std::string>& sets) {
  try {
    load_config({resolved, "what-if.yaml"}, sets, {.force = true});
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

}  // namespace

Config tester_limited(const Config& config) {
  Config machine = config;
  const bool valid = may_be_set(resolved_yaml(config), {});
  for (const PartClass& part : kPartClasses) {
    for (int i = 0; i < part.times && part.present(machine); ++i) {
      Config next = machine;
      part.relax(next);
      const std::vector<std::string> sets = felt_differences(machine, {}, next);
      if (sets.empty() || (valid && !may_be_set(resolved_yaml(machine), sets))) break;
      machine = std::move(next);
    }
  }
  return machine;
}

std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel) {
  std::vector<WhatIf> all;
  const std::string resolved = resolved_yaml(config);
  const SceneFacts scene = scene_facts(accel);
  const bool valid = may_be_set(resolved, {});  // a test's machine may lack keys that what-ifs do not touch
  const auto add = [&](const char* name, std::string action, const auto& relax, bool keeps_shapes = false) {
    WhatIf what_if{name, std::move(action), {}, relax, config, keeps_shapes};
    relax(what_if.relaxed);
    what_if.sets = felt_differences(config, scene, what_if.relaxed);
    if (what_if.sets.empty() || (valid && !may_be_set(resolved, what_if.sets))) return;
    all.push_back(std::move(what_if));
  };
  for (const UnitKindRow& row : kUnitKinds)
    add(row.work, fmt::format("twice testers.{}.units", row.key), [kind = row.kind](Config& c) {
      for_all_testers(c, [&](TestersConfig& testers) { testers.units[kind].units *= 2; });
    });
  for (const PartClass& part : kPartClasses)
    if (part.present(config)) add(part.name, part.action, part.relax, part.keeps_shapes);
  return all;
}

std::optional<Config> relaxed_together(const Config& config, const std::vector<const WhatIf*>& members) {
  Config relaxed = config;
  for (const WhatIf* member : members) member->relax(relaxed);
  const std::string resolved = resolved_yaml(config);
  if (may_be_set(resolved, {}) && !may_be_set(resolved, config_differences(config, relaxed))) return std::nullopt;
  return relaxed;
}

}  // namespace carousel::ringbus
