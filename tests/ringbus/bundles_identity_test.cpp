// With bundles or without: one digest, on the native ring and on the cycle engine, however they are made, tested, split
// and made again; nothing is lost, and every rare path is seen to have been taken.
#include <gtest/gtest.h>

#include "tests/ringbus/factors.h"
#include "tests/ringbus/identity_cells.h"

namespace carousel::ringbus {
namespace {

using Order = BundlesConfig::Order;

std::vector<Factor> bundle_factors() {
  using I = std::int64_t;
  using Builder = BundlesConfig::Builder;
  return {
      factor<I>("size", {2, 4, 8, 16, 32}, [](Cell& c, I v) { c.config.bundles.size = v; }),
      factor("form", all(BundlesConfig::Form{}), [](Cell& c, BundlesConfig::Form v) { c.config.bundles.form = v; }),
      factor("order", all(BundlesConfig::Order{}), [](Cell& c, BundlesConfig::Order v) { c.config.bundles.order = v; }),
      factor<bool>("strict", {false, true}, [](Cell& c, bool v) { c.config.bundles.strict = v; }),
      factor("lifetime", all(BundlesConfig::Lifetime{}),
             [](Cell& c, BundlesConfig::Lifetime v) { c.config.bundles.lifetime = v; }),
      factor("split", all(BundlesConfig::Split{}), [](Cell& c, BundlesConfig::Split v) { c.config.bundles.split = v; }),
      factor("sources", all(BundlesConfig::Sources{}), [](Cell& c, BundlesConfig::Sources v) { c.config.bundles.sources = v; }),
      factor<I>("min rays", {2, 3}, [](Cell& c, I v) { c.config.bundles.min_rays = v; }),
      factor<I>("depth", {0, 2, 255}, [](Cell& c, I v) { c.config.bundles.split_below.depth = v; }),
      factor<double>("box", {0, 0.2}, [](Cell& c, double v) { c.config.bundles.split_below.box_size = v; }),
      factor<I>("open", {1, 4, 64}, [](Cell& c, I v) { c.config.bundles.builder.open = v; }),
      factor<I>("age", {3, 64}, [](Cell& c, I v) { c.config.bundles.builder.age = v; }),
      factor("similarity", all(Builder::Similarity{}),
             [](Cell& c, Builder::Similarity v) { c.config.bundles.builder.similarity = v; }),
      factor("measure", all(Builder::Measure{}), [](Cell& c, Builder::Measure v) { c.config.bundles.builder.measure = v; }),
      // Scattered rays are hardly alike: what counts here is that they come together at all.
      factor<double>("threshold", {0.3, 100}, [](Cell& c, double v) { c.config.bundles.builder.threshold = v; }),
      factor<bool>("same origin", {false, false, true}, [](Cell& c, bool v) { c.config.bundles.builder.same_origin = v; }),
      factor<bool>("same signs", {false, true}, [](Cell& c, bool v) { c.config.bundles.builder.same_signs = v; }),
  };
}

std::vector<TestScene> scenes() {
  std::vector<TestScene> all;
  all.emplace_back(builtin_scene(BuiltinScene::kInstances, 0, 300), 150, 3);
  all.emplace_back(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 150, 3);
  all.emplace_back(builtin_scene(BuiltinScene::kCornell, 0, 0), 150, 3);
  return all;
}

Cell draw(std::mt19937& random, const std::vector<Factor>& machine, const std::vector<Factor>& bundles) {
  for (;;) {
    Cell cell;
    for (const std::vector<Factor>* factors : {&machine, &bundles})
      for (const Factor& f : *factors) f.levels[random() % f.levels.size()](cell);
    if (possible(cell.config)) return cell;
  }
}

std::string text(const BundlesConfig& b) {
  return fmt::format("size {} {} {}{} {} split {} from {} min {} below {} {} open {} age {} {} {} {}{}{}", b.size, enum_name(b.form),
                     enum_name(b.order), b.strict ? " strict" : "", enum_name(b.lifetime), enum_name(b.split),
                     enum_name(b.sources), b.min_rays, b.split_below.depth, b.split_below.box_size, b.builder.open,
                     b.builder.age, enum_name(b.builder.similarity), enum_name(b.builder.measure), b.builder.threshold,
                     b.builder.same_origin ? " same origin" : "", b.builder.same_signs ? " same signs" : "");
}

void expect_one_digest(const std::vector<Factor>& machine, std::uint32_t number, int cells) {
  const std::vector<Factor> bundles = bundle_factors();
  BundleCounts sum;
  for (TestScene& scene : scenes()) {
    std::mt19937 random(number + 7919 * run_seed());
    for (int i = 0; i < cells; ++i) {
      Cell cell = draw(random, machine, bundles);
      if (cell.config.engine.kind == EngineKind::kCycle) cell.threads = 1 + static_cast<std::size_t>(i % 2);
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << "CAROUSEL_SEED=" << run_seed() << " " << text(cell.config.bundles) << "; " << cell.text();
      for (const BundleCounts& at_depth : outcome.sum.bundles) sum += at_depth;
    }
  }
  const auto some = static_cast<std::uint64_t>(cells);   // scattered rays seldom all hit a box
  EXPECT_GT(sum.formed, some);
  EXPECT_GT(sum.all, some);
  EXPECT_GT(sum.none, some);
  EXPECT_GT(sum.split, some);
  EXPECT_GT(sum.taken_apart, some);
}

TEST(BundlesIdentity, NativeRingGivesTheTracersDigest) { expect_one_digest(machine_factors(), 5, cell_count(120)); }
TEST(BundlesIdentity, CycleEngineGivesTheTracersDigest) { expect_one_digest(cycle_factors(), 6, cell_count(40)); }

// A bundle that splits joins collections with many IDs at once, for which the reserve must have room.
TEST(BundlesIdentity, TheLeastStorageIsEnough) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 2000, 2);
  std::uint64_t reserves = 0, split = 0;
  for (const std::int64_t size : {2, 8, 32}) {
    for (const Order order : {Order::kAllHitFirst, Order::kAnyHitOnly}) {
      Cell cell;
      Config& c = cell.config;
      c.topology.resources = 2;
      c.rays.slots_per_resource = 4096;
      c.packets.rays = 1;
      c.collections.ready = 4;
      c.collections.policy = Policy::kOldest;   // breadth first fills it
      c.bundles.size = size;
      c.bundles.order = order;
      c.bundles.builder.threshold = 100;
      c.bundles.builder.same_signs = false;
      cell.tight_storage = true;
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << text(c.bundles);
      reserves += outcome.sum.stalls[static_cast<std::size_t>(StallReason::kReserve)];
      for (const BundleCounts& at_depth : outcome.sum.bundles) split += at_depth.split;
    }
  }
  EXPECT_GT(reserves, 0u) << "storage was never short";
  EXPECT_GT(split, 100u);
}

TEST(BundlesIdentity, CycleEngineTakesTheSameCyclesOnAnyNumberOfThreads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 150, 3);
  const std::vector<Factor> machine = cycle_factors(), bundles = bundle_factors();
  std::mt19937 random(9 + 7919 * run_seed());
  for (int i = 0; i < cell_count(8); ++i) {
    Cell cell = draw(random, machine, bundles);
    cell.threads = 1;
    const Outcome alone = run_cell(scene, cell);
    ASSERT_TRUE(alone.result.cycle.has_value()) << alone.fault;
    for (const std::size_t threads : {2, 3}) {
      cell.threads = threads;
      EXPECT_TRUE(run_cell(scene, cell).result.cycle == alone.result.cycle)
          << "CAROUSEL_SEED=" << run_seed() << " " << text(cell.config.bundles) << "; " << cell.text();
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
