// A packet's bytes on a link, against the layout as it is documented (docs/internals/cycle-engine-exact.md).
#include "ringbus/cycle/fabric/packet_size.h"

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus::cycle {
namespace {

// Nine rays at an inner node: with the whole strip, and with one of its boxes.
TEST(PacketSize, OneShapeBringsOneBitARayAndOneEntry) {
  const accel::Accel accel =
      accel::build(builtin_scene(BuiltinScene::kTerrain, 1000, 0), BvhConfig{}, *make_sequential_executor(), {});
  const ShapeMemory memory(accel, {});
  Packet strip;
  strip.key = {0, accel.instances[0].root};
  ASSERT_TRUE(strip.key.ref.is_inner());
  strip.members.resize(9);
  Packet single = strip;
  single.lanes = 1u << 1;
  const auto bytes = [&](const Packet& packet, PacketResults results, Policy policy) {
    Config c;
    c.packets.results = results;
    c.collections.policy = policy;
    return PacketSize(c.collections, c.packets, c.topology.link, RayIdLayout(1)).load(packet, memory, false).bytes;
  };
  EXPECT_EQ(bytes(strip, PacketResults::kMask, Policy::kDeepest), 16u + 4 * 9 + 9);
  EXPECT_EQ(bytes(single, PacketResults::kMask, Policy::kDeepest), 16u + 4 * 9 + 2);
  EXPECT_EQ(bytes(strip, PacketResults::kMask, Policy::kNearest), 16u + 4 * 9 + 9 + 8 * 4);
  EXPECT_EQ(bytes(single, PacketResults::kMask, Policy::kNearest), 16u + 4 * 9 + 2 + 4);
  for (Packet* packet : {&strip, &single}) packet->answered = 4;
  EXPECT_EQ(bytes(strip, PacketResults::kImpliedOrder, Policy::kNearest), 18u + 2 + 4 * 5 + 4 + 8 * 4);
  EXPECT_EQ(bytes(single, PacketResults::kImpliedOrder, Policy::kNearest), 18u + 2 + 4 * 5 + 1 + 4);
}

// Nine rays, two of them at a second treelet and four at a third, which leave for three other ones.
TEST(PacketSize, ListsTheWaysOutOfTreeletsAndTheGroupsOfItsRays) {
  const accel::Accel accel =
      accel::build(builtin_scene(BuiltinScene::kTerrain, 1000, 0), BvhConfig{}, *make_sequential_executor(), {});
  const ShapeMemory memory(accel, {});
  Packet packet;
  packet.key = {0, accel.instances[0].root};
  packet.members.resize(9);
  packet.groups = {{3, 1, packet.key}, {5, 2, packet.key}};
  packet.exits.resize(3);
  const auto bytes = [&](Traversal traversal, Policy policy) {
    Config c;
    c.collections.traversal = traversal;
    c.collections.policy = policy;
    return PacketSize(c.collections, c.packets, c.topology.link, RayIdLayout(1)).load(packet, memory, true).bytes;
  };
  EXPECT_EQ(bytes(Traversal::kSpread, Policy::kDeepest), 16u + 4 * 9 + 2 * 10 + 3 * 9);
  EXPECT_EQ(bytes(Traversal::kSpread, Policy::kNearest), 16u + 4 * 9 + 2 * 10 + 3 * (9 + 4));
  packet.exits.clear();
  EXPECT_EQ(bytes(Traversal::kOrdered, Policy::kNearest), 16u + 4 * 9 + 2 * 10 + 9 * 12);
  EXPECT_EQ(packet.place_of(2).depth, packet.depth);
  EXPECT_EQ(packet.place_of(4).depth, 1);
  EXPECT_EQ(packet.place_of(8).depth, 2);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
