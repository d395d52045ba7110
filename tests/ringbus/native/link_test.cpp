#include "ringbus/native/links/link.h"

#include <array>

#include <gtest/gtest.h>

#include "tests/ringbus/queues/queue_kinds.h"

namespace carousel::ringbus {
namespace {

TEST(Link, KnowsItsEndsAndDepth) {
  for (const QueueKind kind : queue_kinds()) {
    const auto link = make_link(kind, 7, ResourceId(2), ResourceId(5));
    EXPECT_EQ(link->from(), ResourceId(2));
    EXPECT_EQ(link->to(), ResourceId(5));
    EXPECT_EQ(link->capacity(), 7u);
    EXPECT_EQ(link->free_places(), 7u);
  }
}

TEST(Link, RefusesWhenFull) {
  for (const QueueKind kind : queue_kinds()) {
    const auto link = make_link(kind, 3, ResourceId(0), ResourceId(1));
    const std::array<PacketId, 2> two{PacketId(10), PacketId(11)};
    EXPECT_EQ(link->try_send(two), 2u);
    EXPECT_EQ(link->try_send(two), 1u);
    EXPECT_EQ(link->try_send(two), 0u);
    std::array<PacketId, 8> got;
    EXPECT_EQ(link->try_receive(got), 3u);
    EXPECT_EQ(got[0], PacketId(10));
    EXPECT_EQ(got[1], PacketId(11));
    EXPECT_EQ(got[2], PacketId(10));
    EXPECT_EQ(link->try_receive(got), 0u);
  }
}

TEST(Link, CountsWhatItsSenderSaw) {
  for (const QueueKind kind : queue_kinds()) {
    const auto link = make_link(kind, 4, ResourceId(0), ResourceId(1));
    const std::array<PacketId, 3> three{PacketId(1), PacketId(2), PacketId(3)};
    (void)link->try_send(three);  // 3 waiting, sampled
    (void)link->try_send(three);  // 2 refused, so full
    (void)link->try_send(three);  // 3 refused
    std::array<PacketId, 3> got;
    EXPECT_EQ(link->try_receive(got), 3u);
    (void)link->try_send(std::span(three).first(1));
    EXPECT_EQ(link->try_receive(got), 2u);
    EXPECT_EQ(link->try_receive(got), 0u);
    LinkStatistics s = link->statistics();
    EXPECT_EQ(s.batches, 3u);
    EXPECT_EQ(s.full_stalls, 2u);
    EXPECT_EQ(s.receives, 2u);
    EXPECT_EQ(s.empty_stalls, 1u);
    EXPECT_EQ(s.packets, 5u);
    EXPECT_EQ(s.refusals, 5u);
    EXPECT_EQ(s.occupancy_max, 4u);
    EXPECT_EQ(s.occupancy_sum, 3u);
    EXPECT_EQ(s.samples, 1u);
    // The 4th to 17th send, of which the 9th and the 17th are sampled.
    (void)link->try_send(std::span(three).first(1));
    for (int i = 0; i < 13; ++i) {
      (void)link->try_send(std::span(three).first(1));
      EXPECT_EQ(link->try_receive(std::span(got).first(1)), 1u);
    }
    s = link->statistics();
    EXPECT_EQ(s.batches, 17u);
    EXPECT_EQ(s.samples, 3u);
    EXPECT_EQ(s.occupancy_sum, 3u + 2u + 2u);
  }
}

TEST(Link, OffItCountsNothing) {
  const auto link = make_link(QueueKind::kSpscRing, 4, ResourceId(0), ResourceId(1));
  link->count(false);
  const std::array<PacketId, 1> one{PacketId(1)};
  EXPECT_EQ(link->try_send(one), 1u);
  EXPECT_EQ(link->statistics().packets, 0u);
  EXPECT_EQ(link->statistics().samples, 0u);
}

TEST(OccupancySeries, JoinsNeighboursAndLosesNoSample) {
  OccupancySeries series;
  std::uint64_t sum = 0;
  constexpr std::uint64_t kSamples = 32 * 8000;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    series.add(i % 7 + i / 100000);
    sum += i % 7 + i / 100000;
  }
  EXPECT_GE(series.entries().size(), 16u);
  EXPECT_LT(series.entries().size(), 64u);
  std::uint64_t seen = 0, added = 0, most = 0;
  for (const OccupancySeries::Entry& entry : series.entries()) {
    seen += entry.samples;
    added += entry.sum;
    EXPECT_GE(entry.most, most);  // it rises
    most = entry.most;
  }
  EXPECT_LE(kSamples - seen, 32u * 512);  // the open entry has fewer samples than a full one
  EXPECT_LE(added, sum);
  EXPECT_EQ(most, 8u);
}

}  // namespace
}  // namespace carousel::ringbus
