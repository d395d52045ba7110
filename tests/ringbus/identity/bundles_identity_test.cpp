// With bundles or without: one digest, on the native ring and on the cycle engine, however they are made, tested, split
// and made again; nothing is lost, and every rare path is seen to have been taken.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/build/build.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/ringbus/identity/factors.h"
#include "tests/ringbus/identity/identity_cells.h"

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
      factor("sources", all(BundlesConfig::Sources{}),
             [](Cell& c, BundlesConfig::Sources v) { c.config.bundles.sources = v; }),
      factor<I>("min rays", {2, 3}, [](Cell& c, I v) { c.config.bundles.min_rays = v; }),
      factor<I>("depth", {0, 2, 255}, [](Cell& c, I v) { c.config.bundles.split_below.depth = v; }),
      factor<double>("box", {0, 0.2}, [](Cell& c, double v) { c.config.bundles.split_below.box_size = v; }),
      factor<double>("spread", {0, 0, 0.5}, [](Cell& c, double v) { c.config.bundles.split_above.spread = v; }),
      factor<double>("silhouette", {0, 0, 1},
                     [](Cell& c, double v) { c.config.bundles.split_above.silhouette_area = v; }),
      factor("at instances", all(BundlesConfig::AtInstances{}),
             [](Cell& c, BundlesConfig::AtInstances v) { c.config.bundles.at_instances = v; }),
      factor("hint", all(BundlesConfig::Hint{}), [](Cell& c, BundlesConfig::Hint v) { c.config.bundles.hint = v; }),
      factor<I>("open", {1, 4, 64}, [](Cell& c, I v) { c.config.bundles.builder.open = v; }),
      factor<I>("age", {3, 64}, [](Cell& c, I v) { c.config.bundles.builder.age = v; }),
      factor("similarity", all(Builder::Similarity{}),
             [](Cell& c, Builder::Similarity v) { c.config.bundles.builder.similarity = v; }),
      factor("measure", all(Builder::Measure{}),
             [](Cell& c, Builder::Measure v) { c.config.bundles.builder.measure = v; }),
      // Scattered rays are hardly alike: what counts here is that they come together at all.
      factor<double>("threshold", {0.3, 100}, [](Cell& c, double v) { c.config.bundles.builder.threshold = v; }),
      factor<bool>("same origin", {false, false, true},
                   [](Cell& c, bool v) { c.config.bundles.builder.same_origin = v; }),
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
  return fmt::format(
      "size {} {} {}{} {} split {} from {} min {} below {} {} above {} {} {} {} open {} age {} {} {} {}{}{}", b.size,
      enum_name(b.form), enum_name(b.order), b.strict ? " strict" : "", enum_name(b.lifetime), enum_name(b.split),
      enum_name(b.sources), b.min_rays, b.split_below.depth, b.split_below.box_size, b.split_above.spread,
      b.split_above.silhouette_area, enum_name(b.at_instances), enum_name(b.hint), b.builder.open, b.builder.age,
      enum_name(b.builder.similarity), enum_name(b.builder.measure), b.builder.threshold,
      b.builder.same_origin ? " same origin" : "", b.builder.same_signs ? " same signs" : "");
}

void expect_one_digest(const std::vector<Factor>& machine, std::uint32_t number, int cells) {
  const std::vector<Factor> bundles = bundle_factors();
  BundleCounts sum;
  const auto some = static_cast<std::uint64_t>(cells);  // scattered rays seldom all hit a box
  const auto seen = [&] { return std::min({sum.formed, sum.all, sum.none, sum.split, sum.taken_apart}) > some; };
  for (TestScene& scene : scenes()) {
    std::mt19937 random(number + 7919 * run_seed());
    for (int i = 0; i < cells || (!seen() && i < 20 * cells); ++i) {
      Cell cell = draw(random, machine, bundles);
      if (cell.config.engine.kind == EngineKind::kCycle) cell.threads = 1 + static_cast<std::size_t>(i % 2);
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << "CAROUSEL_SEED=" << run_seed() << " " << text(cell.config.bundles) << "; "
                                   << cell.text();
      for (const BundleCounts& at_depth : outcome.sum.bundles) sum += at_depth;
    }
  }
  EXPECT_GT(sum.formed, some);
  EXPECT_GT(sum.all, some);
  EXPECT_GT(sum.none, some);
  EXPECT_GT(sum.split, some);
  EXPECT_GT(sum.taken_apart, some);
}

TEST(BundlesIdentity, NativeRingGivesTheTracersDigest) {
  expect_one_digest(machine_factors(), 5, cell_count(120));
}
TEST(BundlesIdentity, CycleEngineGivesTheTracersDigest) {
  expect_one_digest(cycle_factors(), 6, cell_count(40));
}

/// A grid of rays down onto a scene, hardly spread.
class Beam final : public Workload {
 public:
  Beam(const Aabb& bounds, std::uint32_t side) : bounds_(bounds), side_(side) {}
  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    const std::lock_guard lock(mutex_);
    std::size_t made = 0;
    for (; made < max_rays && next_ < side_ * side_; ++made, ++next_) {
      const auto at = [&](std::uint32_t i) { return (static_cast<float>(i) + 0.5f) / static_cast<float>(side_); };
      const Vec3 e = bounds_.extent();
      RayRequest ray;
      ray.ray.origin = bounds_.lo + Vec3{e.x * at(next_ % side_), 2 * e.y, e.z * at(next_ / side_)};
      ray.ray.direction = {1e-3f * at(next_ % 7), -1, 1e-3f};
      ray.tag.path = next_;
      out.push_back(ray);
    }
    return {made, next_ == side_ * side_};
  }
  void shade(WorkerId, const HitBatch& completed, RayBatch&) override {
    const std::lock_guard lock(mutex_);
    for (const RayResult& r : completed) digest_.add(hit_term(r.tag.path, 0, r.tag, r.hit));
  }
  HitsDigest digest() const { return digest_; }

 private:
  Aabb bounds_;
  std::uint32_t side_, next_ = 0;
  std::mutex mutex_;
  HitsDigest digest_;
};

/// The boxes that bundles of a beam settle.
std::uint64_t settled_in_beam(const scene::Scene& scene, const BundlesConfig& bundles, EngineKind engine) {
  Config config;
  config.engine.kind = engine;
  config.bundles = bundles;
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  const float scene_size = glm::length(scene.bounds().extent());
  Beam beam(scene.bounds(), 64), reference(scene.bounds(), 64);
  const RunResult result =
      (engine == EngineKind::kCycle ? run_cycle : run_native)(config, accel, scene_size, beam, on_threads(1));
  accel::run_reference(accel, reference);
  EXPECT_EQ(beam.digest().hex(), reference.digest().hex()) << text(bundles);
  std::uint64_t lanes = 0;
  for (const ResourceStatistics& r : result.resources)
    for (const BundleCounts& at_depth : r.bundles) lanes += at_depth.all + at_depth.none;
  return lanes;
}

/// The boxes that bundles of scattered rays settle.
std::uint64_t settled(TestScene& scene, const BundlesConfig& bundles, EngineKind engine) {
  Cell cell;
  cell.config.engine.kind = engine;
  cell.config.bundles = bundles;
  const Outcome outcome = run_cell(scene, cell);
  EXPECT_EQ(outcome.fault, "") << text(bundles);
  std::uint64_t lanes = 0;
  for (const BundleCounts& at_depth : outcome.sum.bundles) lanes += at_depth.all + at_depth.none;
  return lanes;
}

TEST(BundlesIdentity, RaysMayStayTogetherBelowInstances) {
  scene::Scene scene = accel::icosphere_scene(4);
  scene.instances[0].world_from_model = {Mat3(Vec3{2, 0.3f, 0}, Vec3{0, 1, 0.2f}, Vec3{-0.1f, 0, 3}), {1, 2, 3}};
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.builder.threshold = 0.2;
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    bundles.at_instances = BundlesConfig::AtInstances::kSplit;
    const std::uint64_t above = settled_in_beam(scene, bundles, engine);
    bundles.at_instances = BundlesConfig::AtInstances::kRebound;
    EXPECT_GT(settled_in_beam(scene, bundles, engine), 2 * above) << enum_name(engine);
  }
}

TEST(BundlesIdentity, WideBundlesSplit) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 1000, 0);
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.builder.threshold = 0.5;
  const std::uint64_t all = settled(scene, bundles, EngineKind::kNative);
  bundles.split_above.spread = 0.1;
  const std::uint64_t narrow = settled(scene, bundles, EngineKind::kNative);
  EXPECT_LT(narrow, all);
  bundles.split_above = {0, 1e9};
  EXPECT_EQ(settled(scene, bundles, EngineKind::kNative), all);
  bundles.split_above = {0, 0.05};
  EXPECT_LT(settled(scene, bundles, EngineKind::kNative), all);
  bundles.split_above = {1e-6, 0};
  EXPECT_LT(settled(scene, bundles, EngineKind::kNative), narrow);
}

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
      c.collections.policy = Policy::kOldest;  // breadth first fills it
      c.bundles.size = size;
      c.bundles.order = order;
      c.bundles.builder.threshold = 100;
      c.bundles.builder.same_signs = false;
      cell.tight_storage = true;
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << text(c.bundles);
      reserves += outcome.sum.stalls[StallReason::kReserve];
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
