// The ways in which a run ends: complete, early, stuck, or with an exception of the workload.
#include "ringbus/native/native_engine.h"

#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "core/system/error.h"
#include "ringbus/queues/spsc_ring.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

scene::Scene nothing() {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene.cameras.emplace_back();
  return scene;
}

scene::Scene triangles(std::uint32_t count) {
  scene::Scene scene = nothing();
  scene::Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}, {0, 0.5f, 1}};
  for (std::uint32_t i = 0; i < count; ++i) mesh.indices.insert(mesh.indices.end(), {0u, 1u, 2u + i % 2});
  mesh.triangle_materials.resize(count);
  scene.meshes.push_back(mesh);
  scene.instances.push_back({MeshId(0), {}});
  return scene;
}

Config small_config() {
  Config c;
  c.topology.resources = 4;
  c.rays.slots_per_resource = 64;
  c.packets.rays = 8;
  c.collections.ready = 8;
  return c;
}

// Structures with nothing above the leaves, or nothing at all.
TEST(NativeEngine, RunsTheSmallestScenes) {
  for (const std::uint32_t count : {1u, 2u, 5u}) {
    TestScene scene(triangles(count), 300, 2);
    for (const Traversal traversal : {Traversal::kSpread, Traversal::kOrdered, Traversal::kTreelet}) {
      for (const PacketShapes shapes : {PacketShapes::kStrip, PacketShapes::kSingle}) {
        Cell cell{small_config(), 2};
        cell.config.collections.traversal = traversal;
        cell.config.packets.shapes = shapes;
        cell.config.bvh.leaf_triangles = count == 5 ? 2 : 8;
        cell.tight_storage = true;
        if (is_accepted(cell.config)) {
          EXPECT_EQ(run_cell(scene, cell).fault, "") << cell.text();
        }
      }
    }
  }
}

TEST(NativeEngine, CompletesEmptyScenesAsMisses) {
  const accel::Accel accel = accel::build(nothing(), BvhConfig{}, *make_sequential_executor());
  for (const Traversal traversal : {Traversal::kSpread, Traversal::kOrdered, Traversal::kTreelet}) {
    for (const Placement placement : {Placement::kBalanced, Placement::kFirstTaker}) {
      Config c = small_config();
      c.collections.traversal = traversal;
      c.rays.placement = placement;
      ScatterWorkload workload({Vec3{-1}, Vec3{1}}, 500, 2, 7);
      const RunResult result = run_native(c, accel, 1, workload, on_threads(2));
      EXPECT_EQ(result.rays_completed, 500u);
      EXPECT_EQ(workload.rays(), 500u);
    }
  }
}

TEST(NativeEngine, NeedsNoCoreAResource) {
  TestScene scene(triangles(5), 300, 2);
  for (const std::size_t threads : {1u, 7u, 16u, 100u}) {
    Cell cell{small_config(), threads};
    cell.config.topology.resources = 16;
    cell.config.shading.workers = 5;
    EXPECT_EQ(run_cell(scene, cell).fault, "") << threads;
  }
}

TEST(NativeEngine, GivesTheSameHitsWithoutStatistics) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 500, 2);
  ScatterWorkload workload = scene.workload();
  RunOptions options = on_threads(2);
  options.statistics = false;
  const RunResult result = run_native(small_config(), scene.accel(BvhConfig{}), scene.size(), workload, options);
  EXPECT_TRUE(result.resources.empty());
  EXPECT_EQ(workload.digest(), scene.digest());
}

/// A queue that counts what passes.
template <class T>
struct CountingQueue : SpscRing<T> {
  using SpscRing<T>::SpscRing;
  std::size_t try_push_n(std::span<const T> values) {
    const std::size_t pushed = SpscRing<T>::try_push_n(values);
    g_pushed += pushed;
    return pushed;
  }
  static inline std::atomic<std::uint64_t> g_pushed{0};
};

TEST(NativeEngine, RunsOnQueuesOfOnesOwn) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 500, 2);
  ScatterWorkload workload = scene.workload();
  const RunResult result = run_native_on(make_queue_link<CountingQueue>, small_config(), scene.accel(BvhConfig{}),
                                         scene.size(), workload, on_threads(2));
  EXPECT_EQ(workload.digest(), scene.digest());
  std::uint64_t sent = 0;
  for (const LinkResult& link : result.links) sent += link.statistics.packets;
  EXPECT_GT(sent, 0u);
  EXPECT_EQ(CountingQueue<PacketId>::g_pushed, sent);

  Config faulty = small_config();
  faulty.faults.links.drop = 0.05;
  ScatterWorkload again = scene.workload();
  run_native_on(make_queue_link<CountingQueue>, faulty, scene.accel(BvhConfig{}), scene.size(), again, on_threads(2));
  EXPECT_EQ(again.digest(), scene.digest());
}

TEST(NativeEngine, LinkCountsAddUpToHops) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 500, 2);
  for (const TopologyShape shape :
       {TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kPointToPoint}) {
    Cell cell{small_config(), 2};
    cell.config.topology.shape = shape;
    const Outcome out = run_cell(scene, cell);
    ASSERT_EQ(out.fault, "");
    std::uint64_t packets = 0;
    for (const LinkResult& link : out.result.links) packets += link.statistics.packets;
    EXPECT_EQ(packets, out.sum.hops);
    EXPECT_EQ(out.sum.seen_rays, 4 * out.sum.packet_rays);  // visit: all
  }
}

/// Makes rays for ever, or throws at some call.
class OddWorkload final : public Workload {
 public:
  int throw_in_generate = -1, throw_in_shade = -1;  // at the n-th call
  bool endless = true;

  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    if (calls_generate_++ == throw_in_generate) throw std::runtime_error("generate failed");
    for (std::size_t i = 0; i < max_rays; ++i)
      out.push_back({{{0, 0, 3}, 0, {0.01f * static_cast<float>(i % 50), 0, -1}}, {}});
    return {max_rays, !endless};
  }
  void shade(WorkerId, const HitBatch&, RayBatch&) override {
    if (calls_shade_++ == throw_in_shade) throw std::runtime_error("shade failed");
  }

 private:
  std::atomic<int> calls_generate_{0}, calls_shade_{0};
};

TEST(NativeEngine, StopTokenLeavesAnIncompleteResult) {
  TestScene scene(triangles(5), 100, 1);
  for (const std::size_t threads : {1u, 3u}) {
    OddWorkload workload;
    std::stop_source stop;
    RunOptions options;
    options.threads = threads;
    options.stop = stop.get_token();
    options.progress = [&](std::uint64_t completed) {
      if (completed > 100) stop.request_stop();
    };
    const RunResult result = run_native(small_config(), scene.accel(BvhConfig{}), 1, workload, options);
    EXPECT_FALSE(result.complete);
    EXPECT_GT(result.rays_completed, 100u);
    EXPECT_GE(result.rays_emitted, result.rays_completed);
  }
}

TEST(NativeEngine, StopBeforeTheStartEndsAtOnce) {
  TestScene scene(triangles(5), 100, 1);
  OddWorkload workload;
  std::stop_source stop;
  stop.request_stop();
  RunOptions options;
  options.stop = stop.get_token();
  EXPECT_FALSE(run_native(small_config(), scene.accel(BvhConfig{}), 1, workload, options).complete);
}

TEST(NativeEngine, WorkloadsExceptionPassesThrough) {
  TestScene scene(triangles(5), 100, 1);
  for (const std::size_t threads : {1u, 2u, 4u}) {
    for (const int call : {0, 3}) {
      for (const bool generate : {true, false}) {
        OddWorkload workload;
        (generate ? workload.throw_in_generate : workload.throw_in_shade) = call;
        try {
          run_native(small_config(), scene.accel(BvhConfig{}), 1, workload, on_threads(threads));
          FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
          EXPECT_STREQ(error.what(), generate ? "generate failed" : "shade failed");
        }
      }
    }
  }
}

/// Has room for few paths at a time and is slow to make more: generate() often gives nothing though more will come.
class ShyWorkload final : public Workload {
 public:
  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    if (++calls_ % 8 != 0) return {0, false};
    std::size_t made = 0;
    while (made < max_rays && left_ > 0 && busy_.load() < 3) {
      ++busy_, --left_, ++made;
      out.push_back({{{0, 0, 3}, 0, {0, 0, -1}}, {}});
    }
    return {made, left_ == 0};
  }
  void shade(WorkerId, const HitBatch& completed, RayBatch&) override {
    shaded += completed.size();
    busy_ -= static_cast<int>(completed.size());
  }
  std::size_t shaded = 0;

 private:
  int left_ = 60, calls_ = 0;
  std::atomic<int> busy_{0};
};

TEST(NativeEngine, AsksAgainWhenTheWorkloadHasNoRaysYet) {
  TestScene scene(triangles(5), 100, 1);
  ShyWorkload workload;
  Config c = small_config();
  c.shading.workers = 1;
  run_native(c, scene.accel(BvhConfig{}), 1, workload, on_threads(2));
  EXPECT_EQ(workload.shaded, 60u);
}

// Nothing bounds the packets on the way: both resources fill their link and their hands before they look at what
// comes in, whatever the threads do.
TEST(NativeEngine, StuckRingSaysWhoWaitsForWhom) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 500, 2);
  Config c = small_config();
  c.topology.resources = 2;
  c.topology.flow = Flow::kNone;
  c.topology.link.depth = 1;
  c.packets.rays = 1;
  c.collections.ready = 1;
  c.shading.workers = 1;
  ScatterWorkload workload = scene.workload();
  RunOptions options;
  options.threads = 1;  // one thread: the order of steps is fixed
  options.stuck_after = std::chrono::milliseconds(300);
  try {
    run_native(c, scene.accel(BvhConfig{}), scene.size(), workload, options);
    FAIL() << "it did not get stuck";
  } catch (const SimulationError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("no progress for 300 ms"), std::string::npos) << text;
    EXPECT_NE(text.find("resource 0: "), std::string::npos) << text;
    EXPECT_NE(text.find("waits for a place in the link to resource 1 (depth 1"), std::string::npos) << text;
    EXPECT_NE(text.find("waits for a place in the link to resource 0 (depth 1"), std::string::npos) << text;
    EXPECT_NE(text.find("first ray "), std::string::npos) << text;
  }
}

// A rest that was asked for ends by itself, however long nobody gets on meanwhile.
TEST(NativeEngine, APauseIsNotTakenForAHalt) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 200, 2);
  Config c = small_config();
  c.engine.clock_mhz = 1000;
  c.faults.resource = {FaultsConfig::Resource::Kind::kPause, 0, 20, 400'000'000, 4};  // 400 ms
  ScatterWorkload workload = scene.workload();
  RunOptions options = on_threads(2);
  options.stuck_after = std::chrono::milliseconds(100);
  const RunResult result = run_native(c, scene.accel(BvhConfig{}), scene.size(), workload, options);
  EXPECT_EQ(result.rays_emitted, result.rays_completed);
}

}  // namespace
}  // namespace carousel::ringbus
