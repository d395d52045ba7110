#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/system/error.h"
#include "ringbus/ranks/compare_clocks.h"
#include "ringbus/ranks/gather_timeline.h"
#include "tests/ringbus/ranks/thread_transport.h"

namespace carousel::ringbus {
namespace {

/// Runs a function at each rank.
template <class F>
void at_each_of(std::uint32_t ranks, F&& function) {
  RankThreads all(ranks);
  std::vector<std::jthread> threads;
  for (std::uint32_t r = 0; r < ranks; ++r)
    threads.emplace_back([&all, &function, r] {
      ThreadTransport transport(all, r);
      function(transport);
    });
}

TEST(RankClocks, AreKnownToWithinTheirUncertainty) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::vector<std::int64_t> ahead{0, 5 * kSecond, 0, -3000 * kSecond};
  const std::vector<std::string> identities{"a host", "another", "a host", ""};  // the last one does not tell
  std::vector<std::vector<RankClock>> found(4);
  at_each_of(4, [&](Transport& transport) {
    const std::uint32_t rank = transport.rank();
    const std::vector<std::uint64_t> left_behind(9);  // by a run that has ended
    transport.send((rank + 1) % 4, left_behind);
    found[rank] = compare_clocks(transport, identities[rank], [&] {
      return std::chrono::steady_clock::now().time_since_epoch().count() + ahead[rank];
    });
  });
  for (const auto& clocks : found) EXPECT_EQ(clocks, found[0]);  // every rank knows all
  ASSERT_EQ(found[0].size(), 4u);
  EXPECT_EQ(found[0][0], RankClock());
  EXPECT_EQ(found[0][2], RankClock());  // ranks 0 and 2 have one clock
  for (const std::size_t rank : {1u, 3u}) {
    const RankClock& clock = found[0][rank];
    EXPECT_GT(clock.uncertainty, 0u);
    EXPECT_LT(clock.uncertainty, static_cast<std::uint64_t>(kSecond));
    EXPECT_LE(std::abs(clock.ahead - ahead[rank]), static_cast<std::int64_t>(clock.uncertainty)) << rank;
  }
}

TEST(RankClocks, AreNamedByTheHost) {
  EXPECT_EQ(clock_identity(), clock_identity());
}

TEST(RankTimeline, HasAllSlicesOnOneClock) {
  const std::vector<RankClock> first{{}, {500, 20}, {-70, 30}}, last{{}, {700, 10}, {-70, 40}};
  Timeline joined;
  at_each_of(3, [&](Transport& transport) {
    const std::uint32_t rank = transport.rank();
    const std::string part = "rank " + std::to_string(rank);
    Timeline own{{{part, "unused"}, {part, "used"}}, {}, 1000u + rank, rank == 2};
    own.slices = {{.begin = 100, .end = 500, .track = 1, .packet = rank}, {.begin = 500, .end = 1000, .track = 1}};
    if (rank == 1)  // more than fit into one message
      for (std::uint64_t i = 0; i < 40'000; ++i) own.slices.push_back({.begin = 1000, .end = 1000, .track = 1});
    gather_timeline(transport, first, last, own);
    if (rank == 0) joined = std::move(own);
  });
  ASSERT_EQ(joined.tracks, (std::vector<SliceTrack>{{"rank 0", "used"}, {"rank 1", "used"}, {"rank 2", "used"}}));
  EXPECT_EQ(joined.clocks, (std::vector<RankClock>{{}, {500, 20}, {-70, 40}}));
  EXPECT_EQ(joined.end, 1002u);
  EXPECT_TRUE(joined.cut);
  ASSERT_EQ(joined.slices.size(), 40'006u);
  // Rank 1's clock gained 200 in its 1001, so its 500 was 400.
  EXPECT_EQ(joined.slices[0], (Slice{.begin = 80, .end = 400, .track = 1, .packet = 1}));
  EXPECT_EQ(joined.slices[1], (Slice{.begin = 100, .end = 500, .track = 0, .packet = 0}));
  EXPECT_EQ(joined.slices[2], (Slice{.begin = 100, .end = 500, .track = 2, .packet = 2}));
  EXPECT_EQ(joined.slices[3], (Slice{.begin = 400, .end = 800, .track = 1}));
  for (std::size_t i = 1; i < joined.slices.size(); ++i) EXPECT_GE(joined.slices[i].begin, joined.slices[i - 1].begin);
}

}  // namespace
}  // namespace carousel::ringbus
