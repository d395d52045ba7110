// The IDs of all resources at one time: the same times for all, and numbers as they were then.
#include "ringbus/cycle/tile/records/id_census.h"

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

TEST(IdCensus, SamplesTheNumberAtTheEndOfACycle) {
  IdCensus census;
  census.until(0, 0);  // the number changes in cycle 0 ...
  census.until(2, 7);  // ... to 7, and in cycle 2 ...
  census.until(5, 3);  // ... to 3
  EXPECT_EQ(census.samples(), (std::vector<std::uint32_t>{7, 7, 3, 3, 3}));
  EXPECT_EQ(census.interval(), 1u);
}

TEST(IdCensus, LooksAtTheSameTimesHoweverOftenItIsCalled) {
  IdCensus often, seldom;
  for (Cycle now = 0; now < 100'000; ++now) often.until(now, now == 0 ? 0 : (now - 1) / 1000);
  often.until(100'000, 99);
  for (Cycle now = 0; now < 100'000; now += 1000) seldom.until(now, now == 0 ? 0 : now / 1000 - 1);
  seldom.until(100'000, 99);
  EXPECT_EQ(often.interval(), 32u);
  EXPECT_EQ(seldom.interval(), often.interval());
  EXPECT_EQ(seldom.samples(), often.samples());
  ASSERT_EQ(often.samples().size(), 3125u);
  for (std::size_t i = 0; i < often.samples().size(); ++i) ASSERT_EQ(often.samples()[i], 32 * i / 1000);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
