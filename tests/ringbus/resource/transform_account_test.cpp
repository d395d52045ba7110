// The transform unit's charges: tests, cycles and bytes change with the policies, and no bit of a hit does.
#include "ringbus/resource/visit/transform_account.h"

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "ringbus/cycle/fabric/packet_size.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/testers/tester.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

using Data = AccuracyConfig::InstanceData;

scene::Scene placed_quads() {
  scene::Scene scene = builtin_scene(BuiltinScene::kInstances, 0, 4);
  scene.instances[0].world_from_model = {Mat3(1.0f), Vec3(0.0f)};
  scene.instances[1].world_from_model = {Mat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}), {5, 6, 7}};
  scene.instances[2].world_from_model = {Mat3(2.0f), {5, 6, 7}};
  return scene;
}

accel::Accel build_at(const scene::Scene& scene, const AccuracyConfig& accuracy) {
  return accel::build(scene, BvhConfig{}, *make_sequential_executor(), accuracy);
}

TEST(TransformAccount, KeepsACopyForEachRayAndInstance) {
  AccuracyConfig accuracy;
  accuracy.transformed_ray = AccuracyConfig::TransformedRay::kStore;
  const accel::Accel accel = build_at(placed_quads(), accuracy);
  TransformAccount account(accuracy, accel, 8);
  EXPECT_FALSE(account.moves(kNoInstance));
  EXPECT_FALSE(account.moves(0));
  EXPECT_TRUE(account.moves(1));
  EXPECT_TRUE(account.needs(3, 1));
  EXPECT_TRUE(account.needs(3, 2));
  EXPECT_TRUE(account.needs(4, 1));
  EXPECT_FALSE(account.needs(3, 1));
  account.forget(3);
  EXPECT_TRUE(account.needs(3, 1));
  EXPECT_FALSE(account.needs(4, 1));
  EXPECT_EQ(account.bytes(), (TransformedRayBytes{4 * 24, 2 * 24, 3 * 24}));
}

TEST(TransformAccount, RecomputesWithoutACopy) {
  const AccuracyConfig accuracy;
  const accel::Accel accel = build_at(placed_quads(), accuracy);
  TransformAccount account(accuracy, accel, 8);
  for (int visit = 0; visit < 3; ++visit) EXPECT_TRUE(account.needs(3, 1));
  EXPECT_EQ(account.bytes(), TransformedRayBytes{});
}

TEST(TransformAccount, InvertsWhatIsStoredForwardUnlessItIsTransposed) {
  AccuracyConfig accuracy;
  for (const auto& level : kEnumNames<TransformLevel>) {
    accuracy.transform = level.value;
    const accel::Accel accel = build_at(placed_quads(), accuracy);
    for (const auto& data : kEnumNames<Data>) {
      accuracy.instance_data = data.value;
      const TransformAccount account(accuracy, accel, 1);
      const bool forward = data.value == Data::kForward, whole = level.value == TransformLevel::kInverseMatrix;
      IntersectionCounts any, turned;
      account.invert(2, any);
      account.invert(1, turned);
      EXPECT_EQ(any.inversions, forward);
      EXPECT_EQ(any.full_inversions, forward && whole);  // the two steps need no more than the linear part's
      EXPECT_EQ(turned.inversions, forward && level.value != TransformLevel::kTransposeIfRotation);
    }
  }
}

TEST(InstanceData, IsWhatTheLevelReads) {
  AccuracyConfig a;
  EXPECT_EQ(accel::stored_instance_data(a), Data::kRt);
  EXPECT_EQ(accel::instance_bytes(a), 48u);
  a.invert = AccuracyConfig::Invert::kVisit;
  EXPECT_EQ(accel::stored_instance_data(a), Data::kForward);
  a = {};
  a.transform = TransformLevel::kInverseMatrix;
  EXPECT_EQ(accel::stored_instance_data(a), Data::kInverse);
  EXPECT_EQ(accel::instance_bytes(a), 48u);
  a.transform = TransformLevel::kTwoStepDouble;
  EXPECT_EQ(accel::instance_bytes(a), 84u);
  a.instance_data = Data::kForward;  // the scene's floats
  EXPECT_EQ(accel::instance_bytes(a), 48u);
}

TEST(InstanceData, TravelsWithThePacketsThatCarryShapes) {
  Config c;
  c.packets.carry = PacketCarry::kData;
  const accel::Accel accel = build_at(placed_quads(), c.accuracy);
  const cycle::ShapeMemory memory(accel, c.accuracy);
  const cycle::PacketSize size(c.collections, c.packets, c.topology.link, RayIdLayout(1));
  Packet packet;
  packet.key = {0, accel.instances[0].root};
  const std::uint32_t unmoved = size.load(packet, memory, false).bytes;
  packet.key = {2, accel.instances[2].root};
  EXPECT_EQ(size.load(packet, memory, false).bytes, unmoved + 48);
  EXPECT_EQ(memory.transform(kNoInstance).bytes, 0u);
  EXPECT_GE(memory.transform(1).address,
            accel.nodes.size() * sizeof(accel::Node) + accel.blocks.size() * sizeof(accel::TriangleBlock));
  EXPECT_EQ(memory.transform(2).address, memory.transform(1).address + 64);
}

// Three rays in a unit that starts one a cycle and takes four; eight box units of four cycles.
TEST(Tester, InvertsBeforeItTransforms) {
  TestersConfig config;
  config.units[UnitKind::kTransform] = {1, 1, 4};
  config.units[UnitKind::kBox] = {8, 1, 4};
  IntersectionCounts counts;
  counts.box = 24;
  counts.transforms = 3;
  cycle::Tester plain(config), inverting(config);
  EXPECT_EQ(plain.strip(100, counts), 110u);  // transformed at 104 to 106, their boxes tested at 108 to 110
  counts.inversions = 1;
  EXPECT_EQ(inverting.strip(100, counts), 115u);  // two passes, begun at 100 and 101: at hand at 105
  EXPECT_EQ(plain.bank(UnitKind::kTransform).busy(), 3u);
  EXPECT_EQ(inverting.bank(UnitKind::kTransform).busy(), 5u);
}

struct Machine {
  std::string digest;
  IntersectionCounts tests;
  cycle::CycleResult cycles;
};

Machine run(const scene::Scene& scene, const Config& c) {
  const accel::Accel accel = build_at(scene, c.accuracy);
  const Aabb bounds = scene.bounds();
  ScatterWorkload workload(bounds, 300, 2, 6 + run_seed());
  const RunResult result = run_cycle(c, accel, glm::length(bounds.extent()), workload, {});
  Machine out{workload.digest().hex(), {}, *result.cycle};
  for (const ResourceStatistics& r : result.resources) out.tests += r.tests;
  return out;
}

TEST(TransformPolicies, ChangeTestsBytesAndCyclesButNoHit) {
  const scene::Scene scene = builtin_scene(BuiltinScene::kInstances, 0, 200);
  for (const TopologyShape shape : {TopologyShape::kRing, TopologyShape::kIndependent}) {
    for (const auto& traversal : kEnumNames<Traversal>) {
      for (const auto& fetch : {MemoryConfig::Fetch::kPacket, MemoryConfig::Fetch::kResource}) {
        SCOPED_TRACE(fmt::format("{} {} {}", enum_name(shape), traversal.name, enum_name(fetch)));
        Config c;
        c.engine.kind = EngineKind::kCycle;
        c.topology.shape = shape;
        c.topology.resources = 4;
        c.collections.traversal = traversal.value;
        c.bvh.treelet_triangles = 200;
        c.rays.slots_per_resource = 64;
        c.memory.fetch = fetch;
        if (fetch == MemoryConfig::Fetch::kPacket) c.packets.carry = PacketCarry::kData;
        c.testers.units[UnitKind::kTransform] = {1, 200,
                                                 200};  // the limit of the run; otherwise order and caches decide
        const Machine today = run(scene, c);
        c.accuracy.instance_data = Data::kForward;
        const Machine forward = run(scene, c);
        c.accuracy.transformed_ray = AccuracyConfig::TransformedRay::kStore;
        const Machine both = run(scene, c);
        c.accuracy.instance_data.reset();
        const Machine stored = run(scene, c);
        for (const Machine* m : {&forward, &both, &stored}) EXPECT_EQ(m->digest, today.digest);
        EXPECT_EQ(today.tests.inversions + stored.tests.inversions, 0u);
        EXPECT_GT(forward.tests.inversions, 0u);
        EXPECT_LE(forward.tests.inversions, forward.tests.transforms);
        EXPECT_GT(forward.cycles.cycles, today.cycles.cycles);
        EXPECT_LE(stored.tests.transforms, today.tests.transforms);
        if (shape == TopologyShape::kRing) {  // elsewhere a ray comes to an instance once
          EXPECT_LT(stored.tests.transforms, today.tests.transforms);
          if (traversal.value != Traversal::kTreelet) {  // where few rays come again
            EXPECT_LT(stored.cycles.cycles, today.cycles.cycles);
          }
          EXPECT_LT(both.tests.inversions, forward.tests.inversions);
        }
        TransformedRayBytes bytes;
        for (const cycle::TileResult& tile : stored.cycles.tiles) {
          bytes.written += tile.transformed_rays.written;
          bytes.read += tile.transformed_rays.read;
        }
        EXPECT_EQ(bytes.written, 24 * stored.tests.transforms);
        for (const cycle::TileResult& tile : today.cycles.tiles)
          EXPECT_EQ(tile.transformed_rays, TransformedRayBytes{});
      }
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
