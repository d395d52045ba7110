// The verdict names the bottleneck: each is planted in turn in a machine that has plenty of everything else; and on
// random machines the class it names, from a pilot only, is the one whose what_if gains most in the whole run.
#include "ringbus/verdict/what_if.h"

#include <gtest/gtest.h>

#include "ringbus/verdict/bottleneck_search.h"
#include "tests/ringbus/support/generous_machine.h"

namespace carousel::ringbus {
namespace {

std::vector<Plant> plants() {
  return {
      {"box_tests",
       [](Config& c) {
         c.testers.units[UnitKind::kBox] = {1, 8, 8};
       }},
      {"triangle_tests",
       [](Config& c) {
         c.testers.units[UnitKind::kTriangle] = {1, 40, 40};
       }},
      {"dispatch", [](Config& c) { c.packets.ids_per_cycle = 1, c.packets.rays = c.collections.ready = 128; }},
      {"link_bandwidth",
       [](Config& c) {
         c.topology.shape = TopologyShape::kBidirectional;  // on a ring one way another direction gains as much
         c.topology.link.bytes_per_cycle = 1;
       }},
      {"memory_bandwidth",
       [](Config& c) {
         c.memory.dram_bytes_per_cycle = 4, c.memory.l2_kib = 1;
         c.memory.shape_buffer_kib = 4;  // with one that holds the scene only the first reads take time
       }},
      {"memory_latency",
       [](Config& c) {
         c.memory.l2_latency_cycles = 2000;
         c.memory.fetch_ahead = 0;
         c.memory.shape_buffer_kib = 1;
       }},
      {"ray_slots",
       [](Config& c) {
         c.rays.slots_per_resource = 4;
         c.topology.link.latency_cycles = 20;
       }},
      {"shading", [](Config& c) { c.shading.workers = 1, c.shading.cycles_per_shade = 200; }},
  };
}

/// The first `paths` rays of a workload, with all rays that follow from them. The rays of the tests' scenes are drawn
/// at random one by one, so any part of them is like the whole.
class FirstPaths final : public Workload {
 public:
  FirstPaths(std::unique_ptr<Workload> whole, std::uint64_t paths) : whole_(std::move(whole)), left_(paths) {}
  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    Generated made = whole_->generate(worker, std::min<std::uint64_t>(max_rays, left_), out);
    left_ -= made.rays;
    made.finished |= left_ == 0;
    return made;
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    whole_->shade(worker, completed, out);
  }

 private:
  std::unique_ptr<Workload> whole_;
  std::uint64_t left_;
};

Bottleneck search(TestScene& scene, const Config& config, std::uint64_t paths, const RunResult& run,
                  std::size_t threads = 1) {
  const PilotFactory pilots = [&](const Config&, std::uint64_t some, std::uint64_t more, std::uint64_t) {
    return std::make_unique<FirstPaths>(scene.new_workload(), some + more);
  };
  return find_bottleneck(config, scene.accel(config.bvh), scene.size(), pilots, {run, paths}, on_threads(threads));
}

TEST(WhatIf, NamesThePlantedBottleneck) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 8000, 2);
  for (const Plant& plant : some(plants(), 3)) {
    Config config = generous_machine();
    config.rays.slots_per_resource = 64;  // small beside the frame
    plant.make(config);
    const Bottleneck found = search(scene, config, 8000, run_whole(scene, config));
    ASSERT_FALSE(found.gains.empty()) << plant.name << ": " << found.unlike << ", " << found.least_paths;
    std::string all;
    for (const Gain& gain : found.gains) all += fmt::format("\n  {} {:+.3f}", gain.name, gain.gain);
    EXPECT_EQ(found.gains.front().name, plant.name) << all;
    EXPECT_GT(found.gains.front().gain, 0.2) << plant.name;
  }
}

// Simulations run at the same time where there are threads. The gains are the same.
TEST(SearchThreads, FindTheSame) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 6000, 2);
  Config config = generous_machine();
  config.rays.slots_per_resource = 16;
  config.shading.workers = 1;
  const RunResult run = run_whole(scene, config);
  const Bottleneck alone = search(scene, config, 6000, run);
  ASSERT_FALSE(alone.gains.empty()) << alone.unlike;
  EXPECT_FALSE(alone.whole);
  const Bottleneck found = search(scene, config, 6000, run, 3);
  EXPECT_EQ(found.paths, alone.paths);
  EXPECT_EQ(found.deviation, alone.deviation);
  ASSERT_EQ(found.gains.size(), alone.gains.size());
  for (std::size_t i = 0; i < alone.gains.size(); ++i) {
    EXPECT_EQ(found.gains[i].name, alone.gains[i].name);
    EXPECT_EQ(found.gains[i].gain, alone.gains[i].gain) << alone.gains[i].name;
    EXPECT_EQ(found.gains[i].low, alone.gains[i].low) << alone.gains[i].name;
    EXPECT_EQ(found.gains[i].together, alone.gains[i].together) << alone.gains[i].name;
  }
}

std::int64_t pick(std::mt19937& random, std::initializer_list<std::int64_t> values) {
  return *(values.begin() + static_cast<std::ptrdiff_t>(random() % values.size()));
}

Config random_machine(std::uint32_t seed) {
  std::mt19937 random(seed);
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.resources = pick(random, {2, 4, 8});
  c.topology.link = {QueueKind::kSpscRing, pick(random, {8, 16}), pick(random, {1, 4, 16}), pick(random, {4, 16, 64})};
  c.topology.visit = random() % 2 == 0 ? Visit::kAll : Visit::kOwners;
  c.packets.ids_per_cycle = pick(random, {2, 8, 32});
  c.collections.when_full = WhenFull::kSpill;
  c.collections.traversal = random() % 2 == 0 ? Traversal::kSpread : Traversal::kTreelet;
  c.bvh.treelet_triangles = 64;
  c.rays.slots_per_resource = pick(random, {16, 64});
  c.testers.units[UnitKind::kBox] = {pick(random, {1, 4, 16}), 1, pick(random, {1, 8})};
  c.testers.units[UnitKind::kTriangle] = {pick(random, {1, 4}), pick(random, {1, 4}), 4};
  c.testers.contexts = pick(random, {1, 2, 4});
  c.memory.l2_latency_cycles = pick(random, {10, 100});
  c.memory.dram_latency_cycles = pick(random, {50, 400});
  c.memory.dram_bytes_per_cycle = pick(random, {4, 32});
  c.memory.l2_kib = pick(random, {8, 256});
  c.shading.workers = pick(random, {1, 4});
  c.shading.cycles_per_shade = pick(random, {4, 20, 60});
  return c;
}

// Every class that gains something by the pilot is relaxed for the whole run: the class named must be best or within 3
// % of it, and the gain foretold within its interval. 30 machines with CAROUSEL_EFFORT=15.
TEST(WhatIf, PredictsRandomMachines) {
  if (!long_tests_run()) GTEST_SKIP() << kInSoak;
  constexpr std::uint32_t kPaths = 24000;  // more than of a pilot
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), kPaths, 2);
  const int machines = cell_count(2);
  int right = 0;
  for (int i = 0; i < machines; ++i) {
    const std::uint32_t seed = run_seed() + static_cast<std::uint32_t>(i);
    const Config config = random_machine(seed);
    const RunResult run = run_whole(scene, config);
    const Bottleneck found = search(scene, config, kPaths, run);
    ASSERT_FALSE(found.gains.empty()) << found.unlike << ", seed " << seed;
    EXPECT_FALSE(found.whole);
    const std::vector<WhatIf> all = what_ifs(config, scene.accel(config.bvh));
    double best = 0, named = 0;
    for (const Gain& gain : found.gains) {
      if (gain.high < 0.05) continue;
      const auto what_if =
          std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name() == gain.name; });
      const double cycles = static_cast<double>(run_whole(scene, what_if->relaxed).cycle->cycles);
      const double real = static_cast<double>(run.cycle->cycles) / cycles - 1;
      best = std::max(best, real);
      if (&gain == &found.gains.front()) named = real;
    }
    const Gain& first = found.gains.front();
    if (named >= best - 0.03 && named >= first.low - 0.01 && named <= first.high + 0.01)
      ++right;
    else
      std::printf("seed %u: named %s, foretold %+.3f (%+.3f to %+.3f), real %+.3f; best %+.3f\n", seed,
                  first.name.c_str(), first.gain, first.low, first.high, named, best);
  }
  EXPECT_GE(right * 10, machines * 9) << "of " << machines << " machines, first seed " << run_seed();
}

}  // namespace
}  // namespace carousel::ringbus
