// Claims of virtual channels by iSLIP of one iteration, by hand.
#include "ringbus/cycle/traffic/channel_claims.h"

#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle::channel_claims_test {
namespace {

/// The queues that get a channel of the range, when these ask for it in one cycle.
std::vector<std::size_t> given(ChannelClaims& claims, const std::vector<std::size_t>& queues, std::size_t begin,
                               std::size_t end) {
  std::vector<std::size_t> out;
  for (const std::size_t queue : queues) claims.ask(queue, begin, end);
  claims.settle([&](std::size_t queue) { out.push_back(queue); });
  return out;
}

TEST(ChannelClaims, OffersOfOneCycleLapse) {
  ChannelClaims claims(3, 2);
  // Both channels offer themselves to queue 0, which takes one; queue 2 comes away with nothing.
  EXPECT_EQ(given(claims, {0, 2}, 0, 2), std::vector<std::size_t>{0});
  EXPECT_EQ(claims.of(0), 0u);
  EXPECT_EQ(given(claims, {2}, 0, 2), std::vector<std::size_t>{2});
  EXPECT_EQ(claims.of(2), 1u);
  EXPECT_FALSE(claims.any_free(0, 2));
  EXPECT_EQ(given(claims, {1}, 0, 2), std::vector<std::size_t>{});
}

TEST(ChannelClaims, QueuesAndChannelsHaveTurns) {
  ChannelClaims claims(3, 2);
  EXPECT_EQ(given(claims, {0, 1}, 0, 1), std::vector<std::size_t>{0});
  claims.release(0);
  // Now queue 1 is before queue 0 at channel 0.
  EXPECT_EQ(given(claims, {0, 1}, 0, 1), std::vector<std::size_t>{1});
  claims.release(1);
  // Queue 0 has had channel 0, and takes the other one of two.
  EXPECT_EQ(given(claims, {0}, 0, 2), std::vector<std::size_t>{0});
  EXPECT_EQ(claims.of(0), 1u);
  // With their turns apart, two queues get a channel each in one cycle: channel 0 is queue 2's, channel 1 queue 1's.
  claims.release(0);
  EXPECT_EQ(given(claims, {1, 2}, 0, 2), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(claims.of(1), 1u);
  EXPECT_EQ(claims.of(2), 0u);
}

TEST(ChannelClaims, RangesAreKept) {
  ChannelClaims claims(4, 4);
  claims.ask(0, 0, 2);
  claims.ask(1, 2, 4);
  claims.ask(2, 2, 3);
  std::vector<std::size_t> out;
  claims.settle([&](std::size_t queue) { out.push_back(queue); });
  EXPECT_EQ(out, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(claims.of(0), 0u);
  EXPECT_EQ(claims.of(1), 2u);
  EXPECT_EQ(claims.of(2), ChannelClaims::kNone);
}

}  // namespace
}  // namespace carousel::ringbus::cycle::channel_claims_test
