// The cost of planes in a simulated machine: units, bytes, and the gain by more units.
#include <algorithm>

#include <gtest/gtest.h>

#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/verdict/what_if.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

TestersConfig plane_testers() {
  TestersConfig c;
  c.units[UnitKind::kBox] = {8, 1, 4};
  c.units[UnitKind::kPlane] = {2, 3, 5};
  return c;
}

TEST(PlaneUnits, StartWhenTheFirstBoxesAreAnswered) {
  Tester tester(plane_testers());
  // 16 boxes: started at 100 and 101, answered at 104 and 105; 10 planes in 5 turns of 3 cycles from 104 on.
  EXPECT_EQ(tester.strip(100, {.box = 16, .plane = 10}), 104 + 4 * 3 + 5);
  EXPECT_EQ(tester.bank(UnitKind::kPlane).busy(), 5 * 3);
  EXPECT_EQ(tester.bank(UnitKind::kPlane).tests(), 10u);
}

TEST(PlaneUnits, AnswerNoSoonerThanTheLastBoxIsFollowed) {
  Tester tester(plane_testers());
  // 80 boxes take 10 cycles; the last ray's plane is tested after its boxes.
  EXPECT_EQ(tester.strip(0, {.box = 80, .plane = 1}), 9 + 4 + 5);
}

TEST(PlaneUnits, CostNothingWithoutPlanes) {
  Tester tester(plane_testers());
  EXPECT_EQ(tester.strip(0, {.box = 16}), 5);
  EXPECT_EQ(tester.ray(100, {.box = 8}), 104);
  EXPECT_EQ(tester.bank(UnitKind::kPlane).busy(), 0);
}

TEST(PlaneUnits, ComeBeforeTheBoxesThatAreLeft) {
  Tester tester(plane_testers(), CullPlanesConfig::Order::kPlanesFirst);
  // 10 planes in 5 turns of 3 cycles, answered from 105 on; the boxes of the last ray when it has been, at 117.
  EXPECT_EQ(tester.strip(100, {.box = 16, .plane = 10}), 100 + 4 * 3 + 5 + 4);
  EXPECT_EQ(tester.bank(UnitKind::kBox).busy(), 2);
  // Many boxes begin at the first answer, at 205.
  EXPECT_EQ(tester.strip(200, {.box = 160, .plane = 2}), 205 + 19 + 4);
  // Planes have culled all children.
  EXPECT_EQ(tester.strip(300, {.plane = 2}), 305);
  EXPECT_EQ(tester.ray(400, {.box = 8, .plane = 2}), 405 + 4);
  EXPECT_EQ(tester.ray(500, {.plane = 2}), 505);
  EXPECT_EQ(tester.strip(600, {.triangle = 4}), 600 + 3 + TestersConfig{}.units[UnitKind::kTriangle].latency_cycles);
}

TEST(PlaneUnits, ServeSingleRays) {
  Tester tester(plane_testers());
  EXPECT_EQ(tester.ray(0, {.box = 8, .plane = 2}), 4 + 5);
  Tester many(plane_testers());
  EXPECT_EQ(many.ray(0, {.box = 8, .plane = 100}), 4 + 49 * 3 + 5);
}

void expect_behind_their_nodes(bool shared_normals) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 2000, 0), 10, 1);
  const accel::Accel& accel =
      scene.accel({}, {.count = 4, .nodes = CullPlanesConfig::Nodes::kAll, .shared_normals = shared_normals});
  const ShapeMemory memory(accel, {});
  std::uint64_t end = 0, bytes = 0;
  for (std::uint32_t i = 0; i < accel.nodes.size(); ++i) {
    const ShapeSpan span = memory.strip({0, accel::NodeRef::inner(i)});
    EXPECT_EQ(span.address, end);
    EXPECT_GE(span.bytes, sizeof(accel::Node));
    end = span.address + span.bytes;
    bytes += span.bytes;
  }
  EXPECT_EQ(bytes, accel.nodes.size() * sizeof(accel::Node) + accel.plane_bytes);
  if (shared_normals) {
    EXPECT_LT(2 * accel.plane_bytes, accel.planes.size() * sizeof(accel::CullPlane));
  } else {
    EXPECT_EQ(accel.plane_bytes, accel.planes.size() * sizeof(accel::CullPlane));
  }
  EXPECT_GE(memory.strip({0, accel::NodeRef::leaf(0, 4)}).address, end);
  EXPECT_GT(accel.planes.size(), 0u);
}

TEST(PlaneBytes, StandBehindTheirNodesWithoutOverlap) {
  expect_behind_their_nodes(false);
  expect_behind_their_nodes(true);
}

TEST(PlaneBytes, TakePlaceInTheShapeBuffer) {
  MemoryConfig config;
  config.shape_buffer_kib = 4;
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  SidePorts ports;
  ports.fetch = &requests;
  ports.fetched = &answers;
  ShapeBuffer buffer(config, LinkConfig{}, ports);
  const auto node = [](std::uint64_t i) { return ShapeNeed{ShapeSpan{4096 + i * 1024, 256 + 8 * 4 * 16}, {}}; };
  for (ShapeBuffer::User user = 0; user < 6; ++user) buffer.take(user, node(user), 0);
  EXPECT_EQ(buffer.fetches(), 5u);  // each takes 12 of the 64 places
  EXPECT_EQ(buffer.counts().room_waits, 1u);
}

TEST(PlaneUnits, AreLiftedWhereThereAreAny) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 200, 0), 1, 1);
  Config config;
  const auto has = [&] {
    const std::vector<WhatIf> all = what_ifs(config, scene.accel(config.bvh, config.cull_planes, config.accuracy));
    return std::any_of(all.begin(), all.end(), [](const WhatIf& what_if) { return what_if.name() == "plane_tests"; });
  };
  EXPECT_FALSE(has());
  config.cull_planes.count = 1;
  EXPECT_TRUE(has());
}

}  // namespace
}  // namespace carousel::ringbus::cycle
