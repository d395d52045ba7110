// The rules by which packets enter a network, and the packets that a resource may send.
#include "ringbus/protocol/flow_rules.h"

#include <gtest/gtest.h>

#include "ringbus/protocol/free_packets.h"

namespace carousel::ringbus {
namespace {

bool may_inject(const FlowRules& rules, bool has_place, std::size_t free_places) {
  return rules.may_inject(has_place, [&] { return free_places; });
}

std::size_t receivable(const FlowRules& rules, std::size_t waiting, std::size_t free_places) {
  return rules.receivable(8, waiting, [&] { return free_places; });
}

TEST(FlowRules, CreditsNeedAPlaceToLeaveFrom) {
  const FlowRules rules(Flow::kCredits, false);
  EXPECT_TRUE(may_inject(rules, true, 0));
  EXPECT_FALSE(may_inject(rules, false, 9));
  EXPECT_EQ(rules.places_to_inject(), 1u);
  EXPECT_EQ(rules.egress_limit(8), 1u);
  EXPECT_TRUE(rules.counts_deliveries());
  EXPECT_FALSE(rules.injects_first());
}

TEST(FlowRules, TheBubbleKeepsAPlaceFree) {
  const FlowRules rules(Flow::kBubble, false);
  EXPECT_TRUE(may_inject(rules, true, 2));
  EXPECT_FALSE(may_inject(rules, true, 1));
  EXPECT_FALSE(may_inject(rules, false, 2));
  EXPECT_EQ(rules.places_to_inject(), 2u);
  // Packets on their way use it up only one by one.
  EXPECT_EQ(receivable(rules, 0, 0), 1u);
  EXPECT_EQ(receivable(rules, 0, 3), 3u);
  EXPECT_EQ(receivable(rules, 0, 20), 8u);
}

TEST(FlowRules, OnARingPacketsThatCannotLeaveDoNotComeIn) {
  for (const Flow flow : {Flow::kCredits, Flow::kBubble, Flow::kNone}) {
    EXPECT_EQ(receivable(FlowRules(flow, false), 1, 9), 0u);
    EXPECT_EQ(receivable(FlowRules(flow, false), 0, 9), 8u);
    EXPECT_EQ(receivable(FlowRules(flow, true), 1, 0), 8u);
  }
}

TEST(FlowRules, SentDirectlyPacketsNeedNoBubble) {
  const FlowRules rules(Flow::kBubble, true);
  EXPECT_FALSE(rules.bubble());
  EXPECT_TRUE(may_inject(rules, true, 0));
  EXPECT_FALSE(FlowRules(Flow::kCredits, true).counts_deliveries());
  EXPECT_GT(rules.egress_limit(8), 1000u);
  EXPECT_EQ(FlowRules(Flow::kNone, true).egress_limit(8), 8u);
}

TEST(FreePackets, DirectionsTakeTurns) {
  FreePackets free(PacketId(10), 2, 2);
  EXPECT_EQ(free.count(), 4u);
  EXPECT_EQ(free.take(), PacketId(11));
  EXPECT_EQ(free.take(), PacketId(13));
  EXPECT_EQ(free.take(), PacketId(10));
  EXPECT_EQ(free.take(), PacketId(12));
  EXPECT_TRUE(free.none());
  EXPECT_EQ(free.take(), std::nullopt);
  free.put(PacketId(13), 1);
  EXPECT_FALSE(free.none());
  EXPECT_EQ(free.take([](std::size_t direction) { return direction == 0; }), std::nullopt);
  EXPECT_EQ(free.take(), PacketId(13));
}

TEST(FreePackets, ADirectionThatMayNotLeaveIsPassedOver) {
  FreePackets free(PacketId(0), 2, 2);
  for (int i = 0; i < 2; ++i) EXPECT_GE(free.take([](std::size_t direction) { return direction == 1; })->value, 2u);
  EXPECT_EQ(free.count(), 2u);
}

}  // namespace
}  // namespace carousel::ringbus
