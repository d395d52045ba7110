// Rays in treelets follow their pointers: to the cycle on hand-made ways, and on machines that a user configures.
#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "accel/traverse/ray_check.h"
#include "ringbus/cycle/fabric/packet_size.h"
#include "ringbus/cycle/tile/walk/subtree_visits.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

struct Strip {
  accel::NodeKey key;
  RayTests tests;
};

/// Visits of one resource, whose cache answers every request after 100 cycles; half of its latency is 17.
struct VisitBench {
  explicit VisitBench(TestScene& scene) : memory(scene.accel({}), {}) {
    MemoryConfig config;
    config.l2_latency_cycles = 34;
    TestersConfig testers;
    testers.units[UnitKind::kBox] = {8, 1, 7};
    testers.units[UnitKind::kTriangle] = {4, 1, 11};
    SidePorts ports;
    ports.fetch = &requests;
    ports.fetched = &answers;
    buffer = std::make_unique<ShapeBuffer>(config, LinkConfig{}, ports);
    tester = std::make_unique<Tester>(testers);
    visits = std::make_unique<SubtreeVisits>(memory, *buffer, *tester, 1, 1, false);
  }
  /// The end of a visit that begins at `at`, of rays with these ways.
  Cycle visit(Cycle at, const std::vector<std::vector<Strip>>& rays) {
    WalkSteps ways;
    for (const std::vector<Strip>& ray : rays) {
      for (const Strip& strip : ray) ways.add(strip.key, {}, strip.tests);
      ways.end_ray();
    }
    visits->prepare(0, ways);
    visits->begin(0, static_cast<std::uint32_t>(rays.size()), at, false);
    Cycle now = at;
    while (!visits->ended(0)) {
      now = std::min({visits->next(), buffer->next(), requests.next()});
      for (; requests.next() <= now; ++fetches) {
        const Cycle arrival = requests.next();
        answers.send(arrival + 100, {requests.take().tag});
      }
      buffer->take_answers(now);
      visits->serve(now);
      visits->run(now);
    }
    return now;
  }

  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  ShapeMemory memory;
  std::unique_ptr<ShapeBuffer> buffer;
  std::unique_ptr<Tester> tester;
  std::unique_ptr<SubtreeVisits> visits;
  std::size_t fetches = 0;
};

TEST(PointerWalk, IsRightToTheCycle) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 300, 0), 10, 0);
  const Strip a{{kNoInstance, accel::NodeRef::inner(0)}, ray_tests({.box = 8})},
      b{{kNoInstance, accel::NodeRef::inner(1)}, ray_tests({.box = 8})},
      c{{kNoInstance, accel::NodeRef::leaf(0, 4)}, ray_tests({.triangle = 4})};
  VisitBench one(scene);
  // 117 cycles for each strip, then its tests.
  EXPECT_EQ(one.visit(50, {{a, b, c}}), 50u + 117 + 7 + 117 + 7 + 117 + 11);
  EXPECT_EQ(one.fetches, 3u);
  EXPECT_EQ(one.visit(1000, {{a, b, c}}), 1000u + 7 + 7 + 11);  // all is there
  VisitBench two(scene);
  // The second ray waits for the same fetches, and takes the units a cycle later.
  EXPECT_EQ(two.visit(50, {{a, b, c}, {a, b, c}}), 50u + 117 + 7 + 117 + 7 + 117 + 1 + 11);
  EXPECT_EQ(two.fetches, 3u);
  VisitBench apart(scene);
  // The second ray asks for c at 174 + 1, and a ray that is done asks for nothing.
  EXPECT_EQ(apart.visit(50, {{a, b}, {a, c}, {}}), 50u + 117 + 8 + 117 + 11);
  EXPECT_EQ(apart.fetches, 3u);
}

TEST(PointerWalk, TakesUnitsOfSeveralKinds) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 300, 0), 10, 0);
  const Strip boxes{{kNoInstance, accel::NodeRef::inner(0)}, ray_tests({.box = 8})},
      planes{{kNoInstance, accel::NodeRef::inner(1)}, ray_tests({.box = 8, .plane = 4})},
      nothing{{kNoInstance, accel::NodeRef::leaf(0, 4)}, {}};
  VisitBench bench(scene);
  // Planes are tested behind boxes, by units of 22 cycles.
  EXPECT_EQ(bench.visit(50, {{boxes, planes, nothing}}), 50u + 117 + 7 + 117 + 7 + 22 + 117);
  EXPECT_EQ(bench.tester->bank(UnitKind::kBox).tests(), 16u);
  EXPECT_EQ(bench.tester->bank(UnitKind::kPlane).tests(), 4u);
  EXPECT_EQ(bench.tester->bank(UnitKind::kTriangle).tests(), 0u);
}

/// For each ray of the scene the strips it reads, and the depth of the deepest.
struct Chain {
  std::set<std::uint32_t> strips;
  std::size_t deepest = 0;
};
std::vector<Chain> chains(TestScene& scene, const accel::Accel& accel) {
  RayBatch rays;
  scene.new_workload()->generate(WorkerId(0), 1000, rays);
  std::vector<Chain> out;
  for (const RayRequest& ray : rays) {
    RayRecord record;
    accel::start_record(ray, record);
    TransformAccount transforms({}, accel, 1);
    RayWalk walk(transforms, ChildOrder::kNearest);
    walk.start(accel.root_key());
    const std::uint32_t slot = 0;
    std::map<std::uint32_t, std::size_t> depth{{accel.root_key().ref.bits(), 1}};
    Chain& chain = out.emplace_back();
    while (const std::optional<accel::NodeKey> key = walk.next(record)) {
      chain.strips.insert(key->ref.bits());
      chain.deepest = std::max(chain.deepest, depth[key->ref.bits()]);
      walk.test(accel, *key, {&record, &slot, 1});
      if (!key->ref.is_inner()) continue;
      for (int lane = 0; lane < accel.nodes[key->ref.node()].count; ++lane)
        depth[accel.child_key(*key, lane).ref.bits()] = depth[key->ref.bits()] + 1;
    }
  }
  return out;
}

constexpr const char* kOneTreelet =
    "topology: {resources: 1}\nrays: {slots_per_resource: 64}\npackets: {rays: 32}\ncollections: {ready: 32, "
    "traversal: "
    "treelet}\nbvh: {treelet_triangles: 1000000}\nshading: {workers: 8, cycles_per_shade: 1}\n"
    "memory: {shape_buffer_kib: 1024, l2_latency_cycles: 1000, dram_latency_cycles: 2, fetch_ahead: 0}\n";

TEST(PointerWalk, OneRayWaitsForEveryStripItReads) {
  for (std::uint32_t paths = 1; paths <= 3; ++paths) {
    TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), paths, 0);
    const std::vector<Chain> chain = chains(scene, scene.accel({}));
    const std::uint64_t fast = cycles_of(scene, kOneTreelet),
                        slow = cycles_of(scene, kOneTreelet, {"memory.l2_latency_cycles=11000"});
    if (paths == 1) {
      EXPECT_EQ(slow - fast, 10'000 * chain[0].strips.size());
    }
    // A strip of another ray may be there already, but none before its parent.
    std::size_t deepest = 0;
    for (const Chain& one : chain) deepest = std::max(deepest, one.deepest);
    EXPECT_GE(slow, 11'000 * deepest);
  }
}

TEST(PointerWalk, ManyRaysTakeAsManyLatenciesAsIndependentOnes) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 32, 0);
  const std::vector<std::string> slow{"memory.l2_latency_cycles=100000"};
  const std::uint64_t treelet = cycles_of(scene, kOneTreelet, slow) / 100'000;
  std::vector<std::string> lone = slow;
  lone.push_back("topology.shape=independent");
  const std::uint64_t independent = cycles_of(scene, kOneTreelet, lone) / 100'000;
  EXPECT_GE(treelet + 1, independent);
  EXPECT_LE(treelet, independent + 1);
  EXPECT_GT(treelet, 8u);
}

// Packets that want the same strip wait for the same fetch, so contexts do not shorten the way from the root to the
// deepest strip.
TEST(FetchByResource, NoTestEndsBeforeItsDataComes) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 8, 0);
  std::size_t deepest = 0;
  for (const Chain& one : chains(scene, scene.accel({}))) deepest = std::max(deepest, one.deepest);
  for (const std::string contexts : {"1", "2", "4"}) {
    const std::uint64_t cycles = cycles_of(
        scene,
        "topology: {resources: 1}\nrays: {slots_per_resource: 64}\npackets: {rays: 1}\ncollections: {ready: 1}\n"
        "shading: {workers: 8, cycles_per_shade: 1}\n"
        "memory: {fetch: resource, shape_buffer_kib: 1024, l2_latency_cycles: 10000, fetch_ahead: 4}\n",
        {"testers.contexts=" + contexts});
    EXPECT_GE(cycles, 10'000 * deepest) << contexts;
  }
}

// A resource with rays for a packet reads its strip, wherever it was issued.
TEST(FetchByResource, IsTheDefaultAndEveryTestReads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 300, 1);
  const Outcome out = run_text(scene,
                               "topology: {resources: 4}\nrays: {slots_per_resource: 32}\npackets: {rays: 8}\n"
                               "collections: {ready: 8, traversal: spread}\nmemory: {shape_buffer_kib: 1}\n");
  std::uint64_t needed = 0;
  for (const TileResult& tile : out.result.cycle->tiles)
    needed += tile.shapes.hits + tile.shapes.merged + tile.shapes.misses;
  EXPECT_GE(needed, out.sum.visits - out.sum.bubbles);
  EXPECT_GT(out.sum.visits - out.sum.bubbles, 1000u);
}

TEST(FetchByResource, LooksAheadForPacketsThatWaitToBeIssued) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 1);
  const auto cycles = [&](const std::string& ahead) {
    return cycles_of(scene,
                     "topology: {resources: 1}\nrays: {slots_per_resource: 256}\npackets: {rays: 8}\n"
                     "collections: {ready: 8}\nshading: {workers: 8, cycles_per_shade: 1}\n"
                     "memory: {fetch: resource, l2_latency_cycles: 300}\n",
                     {"memory.fetch_ahead=" + ahead});
  };
  const std::uint64_t none = cycles("0"), some = cycles("4");
  EXPECT_LT(some * 10, none * 8);
}

// ---- single shapes

TEST(SingleShape, IsChargedForItself) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 300, 0), 10, 0);
  const accel::Accel& accel = scene.accel({});
  const ShapeMemory memory(accel, {});
  const accel::NodeKey node{kNoInstance, accel::NodeRef::inner(1)}, leaf{kNoInstance, accel::NodeRef::leaf(3, 7)};
  EXPECT_EQ(memory.shapes(node, ~0u), memory.strip(node));
  for (int lane = 0; lane < 8; ++lane)
    EXPECT_EQ(memory.shapes(node, 1u << lane), (ShapeSpan{memory.strip(node).address + 32u * lane, 32}));
  for (int lane = 0; lane < 7; ++lane)
    EXPECT_EQ(memory.shapes(leaf, 1u << lane), (ShapeSpan{memory.strip(leaf).address + 40u * lane, 40}));
  Config c;
  c.packets.carry = PacketCarry::kData;
  const PacketSize size(c.collections, c.packets, c.topology.link, RayIdLayout(1));
  Packet packet;
  packet.key = leaf;
  const std::uint32_t whole = size.load(packet, memory, false).bytes;
  packet.lanes = 1;
  EXPECT_EQ(size.load(packet, memory, false).bytes, whole - 320 + 40);
}

TEST(SingleShape, BringsItsPlanesAndTheLeavesItsNodeHolds) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 300, 0), 10, 0);
  BvhConfig bvh;
  bvh.mixed_triangles = 4;
  const accel::Accel& accel = scene.accel(bvh, {.count = 2, .nodes = CullPlanesConfig::Nodes::kAll});
  const ShapeMemory memory(accel, {});
  for (std::uint32_t i = 0; i < accel.nodes.size(); ++i) {
    const accel::NodeKey key{kNoInstance, accel::NodeRef::inner(i)};
    const ShapeSpan whole = memory.strip(key);
    std::uint64_t at = whole.address;
    for (int lane = 0; lane < accel::kMaxWidth; ++lane) {
      const ShapeSpan one = memory.shapes(key, 1u << lane);
      EXPECT_EQ(one.address, at);
      at += one.bytes;
    }
    EXPECT_EQ(at, whole.address + whole.bytes);
  }
}

// ---- order

TEST(ChannelOrder, ArrivalsDoNotGoBackInTime) {
  LooseChannel<int> channel;
  channel.send(5, 1);
  channel.send(5, 2);
  if constexpr (kChecked) {
    EXPECT_THROW(channel.send(4, 3), std::logic_error);
  }
}

}  // namespace
}  // namespace carousel::ringbus::cycle
