// Every class of the machine's parts may be relaxed, as a user would set it, and each what-if changes a machine that
// the class limits.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/config/write.h"
#include "ringbus/results/run_features.h"
#include "tests/ringbus/support/generous_machine.h"

namespace carousel::ringbus {
namespace {

void as_cells(Config& c) {
  c.topology.shape = TopologyShape::kCentral;
  c.topology.resources = 1;
  c.testers.simd.lanes = 16;
  c.testers.units[UnitKind::kBox] = {1, 1, 1};
}

void as_warps(Config& c) {
  c.topology.shape = TopologyShape::kIndependent;
  c.testers.simt.warp = 8;
}

void as_distributor(Config& c) {
  c.topology.shape = TopologyShape::kCentral;
  c.topology.form = CentralForm::kDistributor;
  c.topology.resources = 1;
  c.topology.link = {.latency_cycles = 1, .bytes_per_cycle = 1024};
  c.testers.units[UnitKind::kBox] = {1, 1, 1};
  c.testers.distributor = {
      .testers = 8, .ids_per_cycle = 16, .queue = 64, .out_of_order = 8, .results_per_cycle = 16, .results = 64};
}

void shade_in_vectors(Config& c, std::int64_t lanes) {
  c.shading.workers = 1;
  c.shading.cycles_per_shade = 200;
  c.shading.lanes = lanes;
}

/// A ray by itself that takes nodes in the order in which they lie, one a line, from a slow memory.
void with_prefetcher(Config& c, const StridePrefetcherKeys& prefetcher) {
  c.topology.shape = TopologyShape::kIndependent;
  c.topology.resources = 1;
  c.rays.slots_per_resource = 1;
  c.collections.order = ChildOrder::kStored;
  c.memory.line_bytes = 256;
  c.memory.l2_kib = 16;
  c.memory.shape_buffer_kib = 1;
  c.memory.dram_latency_cycles = 2000;
  c.parts.of<StridePrefetcherPart>() = prefetcher;
}

// Each class has a machine that it limits: relaxing it makes the run shorter. Before issue 16 some what_ifs changed
// nothing, and many keys that cost hardware had no class. In six machines it is scarce but does not limit: more
// bundles are open for longer, with twice the least storage collections go out that would have filled, and vectors of
// rays that are sorted sooner are emptier (+3, +15 and +1 %), and some of the lines that are fetched farther ahead are
// not asked for (+0.03 %). Rays that are packed sooner meet others in their warps (+0.1 %).
TEST(WhatIf, EveryLiftIsNoticed) {
  const std::vector<Plant> slow{
      {"test_latency",
       [](Config& c) {
         c.testers.units[UnitKind::kBox].latency_cycles = 200;
         c.testers.contexts = 1;
       }},
      {"contexts",
       [](Config& c) {
         c.testers.units[UnitKind::kBox].latency_cycles = 200;
         c.testers.contexts = 1;
       }},
      {"ray_reads", [](Config& c) { c.rays.reads_per_cycle = 1; }},
      {"bundle_builder", [](Config& c) { c.bundles.size = 4, c.bundles.builder.rays_per_cycle = 1; }},
      {"bundles_open", [](Config& c) { c.bundles.size = 4, c.bundles.builder.open = 16; }, 0.05},
      {"bundle_tests",
       [](Config& c) {
         c.bundles.size = 4;
         c.testers.units[UnitKind::kBundle] = {1, 1000, 1000};
       }},
      {"collection_storage",
       [](Config& c) { c.collections.when_full = WhenFull::kReserve, c.collections.capacity = 0; }, 0.2},
      {"shape_buffer",
       [](Config& c) { c.memory.shape_buffer_kib = 1, c.memory.l2_latency_cycles = 500, c.memory.fetch_ahead = 0; }},
      {"fetch_ahead", [](Config& c) { c.memory.fetch_ahead = 0, c.memory.l2_latency_cycles = 500; }},
      {"l2_size", [](Config& c) { c.memory.l2_kib = 16, c.memory.dram_latency_cycles = 2000; }},
      {"l1_size", [](Config& c) { c.memory.l1_kib = 2, c.memory.shape_buffer_kib = 1; }},
      {"l1_port", [](Config& c) { c.memory.l1_kib = 64, c.memory.line_bytes = 16, c.memory.shape_buffer_kib = 1; }},
      {"l1_mshrs", [](Config& c) { c.memory.l1_kib = 2, c.memory.l1_mshrs = 1; }},
      {"prefetch", [](Config& c) { with_prefetcher(c, {.lines = 1}); }, 0.001},
      {"prefetch_streams", [](Config& c) { with_prefetcher(c, {.lines = 4, .streams = 1}); }},
      {"l2_mshrs", [](Config& c) { c.memory.l2_mshrs = 1, c.memory.l2_kib = 16, c.memory.dram_latency_cycles = 2000; }},
      {"l2_port",
       [](Config& c) { c.memory.shape_buffer_kib = 1, c.memory.line_bytes = 16, c.memory.l2_lines_per_cycle = 1; }},
      {"issue_rule",
       [](Config& c) { c.collections.partial = Partial::kAfter, c.collections.partial_after_cycles = 20000; }},
      {"rings",
       [](Config& c) {
         c.topology.shape = TopologyShape::kMultiRing;
         c.topology.rings = 1;
         c.topology.link.bytes_per_cycle = 1;
       }},
      {"ring_directions", [](Config& c) { c.topology.link.bytes_per_cycle = 1; }},
      {"packets_in_flight", [](Config& c) { c.topology.link.depth = 2, c.topology.link.latency_cycles = 50; }},
      {"link_latency", [](Config& c) { c.topology.link.latency_cycles = 200, c.rays.slots_per_resource = 16; }},
      {"sorting", [](Config& c) { c.collections.sort_ids_per_cycle = 1; }},
      {"ray_banks", [](Config& c) { as_cells(c), c.rays.banks = 1; }},
      {"cells", [](Config& c) { as_cells(c), c.testers.simd.lanes = 2; }},
      {"distributed_testers", [](Config& c) { as_distributor(c), c.testers.distributor.testers = 1; }},
      {"handing_out", [](Config& c) { as_distributor(c), c.testers.distributor.ids_per_cycle = 1; }},
      {"tester_queues",
       [](Config& c) {
         as_distributor(c);
         c.testers.distributor.queue = c.testers.distributor.results = 1;
         c.topology.link.latency_cycles = 50;
       }},
      {"out_of_order",
       [](Config& c) {
         as_distributor(c);
         c.testers.distributor.out_of_order = 0;
         c.topology.link.latency_cycles = 50;
       }},
      {"decision_point", [](Config& c) { as_distributor(c), c.testers.distributor.results_per_cycle = 1; }},
      {"stragglers",
       [](Config& c) {
         as_distributor(c);
         c.testers.distributor.testers = 2;
         c.testers.units[UnitKind::kBox] = {1, 20, 20};
       },
       0.1},
      {"warp_reads", [](Config& c) { as_warps(c), c.testers.simt.warps = 16; }},
      {"stack_registers", [](Config& c) { as_warps(c), c.testers.simt.stack_entries = 1; }, 0.02},
      {"packing",
       [](Config& c) {
         as_warps(c);
         c.testers.simt.compaction = SimtConfig::Compaction::kRepack;
         c.testers.simt.repack_rays_per_cycle = 1;
       },
       0.01},
      {"shading_lanes", [](Config& c) { shade_in_vectors(c, 2); }},
      {"shading_order", [](Config& c) { shade_in_vectors(c, 8); }},
      {"shading_sorter",
       [](Config& c) {
         shade_in_vectors(c, 8);
         c.shading.cycles_per_shade = 1;
         c.shading.sort = ShadingConfig::Sort::kShader;
         c.shading.sort_rays_per_cycle = 1;
       },
       0.05},
  };
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 600, 2);
  for (const Plant& plant : some(slow, 10)) {
    Config config = generous_machine();
    plant.make(config);
    const accel::Accel& accel = scene.accel(config.bvh);
    if (config.collections.capacity == 0)  // as little as there may be
      config.collections.capacity = minimum_capacity(config, accel.most_ways(), accel.levels());
    const std::vector<WhatIf> all = what_ifs(config, accel);
    const auto what_if =
        std::find_if(all.begin(), all.end(), [&](const WhatIf& one) { return one.name() == plant.name; });
    ASSERT_NE(what_if, all.end()) << plant.name;
    const Cycle before = run_whole(scene, config).cycle->cycles,
                after = run_whole(scene, what_if->relaxed).cycle->cycles;
    EXPECT_NE(after, before) << plant.name;
    EXPECT_LE(static_cast<double>(after), static_cast<double>(before) * (1 + plant.longer)) << plant.name;
  }
}

TEST(WhatIf, LiftsWhatTheMachineHas) {
  const auto has = [](const Config& config, const std::string& name) {
    const std::vector<WhatIf> all = what_ifs(config, accel::Accel());
    return std::any_of(all.begin(), all.end(), [&](const WhatIf& what_if) { return what_if.name() == name; });
  };
  Config c = generous_machine();
  c.topology.link.latency_cycles = 4;
  for (const char* name : {"link_bandwidth", "link_latency", "packets_in_flight", "dispatch", "contexts"})
    EXPECT_TRUE(has(c, name)) << name;
  c.topology.shape = TopologyShape::kIndependent;
  for (const char* name : {"link_bandwidth", "link_latency", "packets_in_flight", "dispatch", "contexts"})
    EXPECT_FALSE(has(c, name)) << name;
  EXPECT_TRUE(has(c, "memory_latency"));
}

// Pools of which each names its workers, or some, or none.
TEST(WhatIf, LiftsTheWorkersOfAllPools) {
  const auto twice = [](const std::string& near, const std::string& far, const std::string& workers) {
    const Config config =
        load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nshading: {workers: " + workers +
                         "}\ntopology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4}\n"
                         "    - {name: near, kind: shading, workers: " +
                         near + ", serves: 'r[0..1]'}\n    - {name: far, kind: shading, workers: " + far +
                         "}\n  links:\n    - {ring: 'r[*]'}\n"
                         "    - {from: 'r[*]', all_to: 'near, far', both: true, carries: [new_rays, completed_rays]}\n",
                     "a.yaml"})
            .config;
    const std::vector<WhatIf> all = what_ifs(config, accel::Accel());
    const auto shading = std::ranges::find_if(all, [](const WhatIf& what_if) { return what_if.name() == "shading"; });
    return shading == all.end() ? std::vector<std::int64_t>() : pool_workers(shading->relaxed);
  };
  EXPECT_EQ(twice("3", "2", "auto"), (std::vector<std::int64_t>{6, 4}));
  EXPECT_EQ(twice("3", "auto", "5"), (std::vector<std::int64_t>{6, 4}));
  EXPECT_EQ(twice("auto", "auto", "5"), (std::vector<std::int64_t>{5, 5}));
}

// A user who sets these keys runs the machine that was simulated; keys at the end of their range have no what_if.
TEST(WhatIf, SaysWhatToSet) {
  const std::string text =
      "scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {dram_bytes_per_cycle: 65536}\n"
      "topology: {overrides: [{resource: 2, testers: {box: {units: 3}}}]}\n";
  const Config config = load_config({text, "a.yaml"}).config;
  const std::vector<WhatIf> all = what_ifs(config, accel::Accel());
  std::set<std::string> names;
  for (const WhatIf& what_if : all) {
    names.insert(what_if.name());
    ASSERT_FALSE(what_if.sets.empty()) << what_if.name();
    EXPECT_EQ(resolved_yaml(load_config({text, "a.yaml"}, what_if.sets).config), resolved_yaml(what_if.relaxed))
        << what_if.name();
  }
  EXPECT_TRUE(names.contains("shading"));
  // A class that has several keys names only those that this machine feels: it has no bundles and no cull planes.
  const auto latency =
      std::find_if(all.begin(), all.end(), [](const WhatIf& one) { return one.name() == "test_latency"; });
  ASSERT_NE(latency, all.end());
  for (const std::string& set : latency->sets) {
    EXPECT_FALSE(set.starts_with("testers.plane.")) << set;
    EXPECT_FALSE(set.starts_with("testers.bundle.")) << set;
  }
  EXPECT_TRUE(names.contains("box_tests"));
  EXPECT_FALSE(names.contains("memory_bandwidth"));
}

TEST(WhatIf, DoublesTheUnitsOfEachKind) {
  Config c = generous_machine();
  c.cull_planes.count = 4;
  c.bundles.size = 4;
  accel::Accel accel;
  accel.procedural_primitives = true;
  accel.planes.emplace_back();
  accel.instances.emplace_back().transform.identity = false;
  c.topology.overrides.push_back({1, c.testers});
  const SceneFacts scene = scene_facts(accel);
  const std::vector<WhatIf> all = what_ifs(c, accel);
  for (const UnitKindRow& row : kUnitKinds) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const WhatIf& one) { return one.name() == row.work; });
    ASSERT_EQ(found != all.end(), has_units(c, scene, row.kind)) << row.work;
    if (found == all.end()) continue;
    const Config& relaxed = found->relaxed;
    for (const auto [kind, units] : relaxed.testers.units) {
      const std::int64_t factor = kind == row.kind ? 2 : 1;
      EXPECT_EQ(units.units, factor * c.testers.units[kind].units) << row.work;
      EXPECT_EQ(relaxed.topology.overrides[0].testers.units[kind].units, units.units) << row.work;
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
