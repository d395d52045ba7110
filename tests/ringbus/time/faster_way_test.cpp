// Which way is faster, by times that are given.
#include "ringbus/time/faster_way.h"

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

using Time = FasterWay::Time;

/// Intervals of 100 runs that take `together` or `alone`, until `end`. Returns the time that was spent alone.
Time alone_until(FasterWay& way, Time& now, Time together, Time alone, Time end) {
  Time spent{0};
  for (bool one = false; now < end;) {
    const Time took = one ? alone : together;
    now += took;
    if (one) spent += took;
    one = one ? way.alone_after_alone(100, took, now) : way.alone_after_together(100, took, now);
  }
  return spent;
}

TEST(FasterWay, TheSlowerOneHasASixteenthOfTheTimeAtMost) {
  for (const int together : {1, 10, 60, 200, 1000}) {
    FasterWay way;
    Time now{0};
    const Time spent = alone_until(way, now, Time(together), Time(100), Time(1'000'000));
    if (together <= 100)
      EXPECT_LE(spent.count() * 16, now.count()) << together;
    else
      EXPECT_LE((now - spent).count() * 16, now.count()) << together;
    EXPECT_GT(spent.count(), 0) << together;
    EXPECT_GT((now - spent).count(), together) << together << ": it is tried again";
  }
}

TEST(FasterWay, AlikeTheyRunTogether) {
  FasterWay way;
  Time now{0};
  const Time spent = alone_until(way, now, Time(100), Time(90), Time(1'000'000));
  EXPECT_LE(spent.count() * 16, now.count());
}

TEST(FasterWay, AHostThatIsFreeAgainIsFoundOut) {
  FasterWay way;
  Time now{0};
  alone_until(way, now, Time(2000), Time(100), Time(1'000'000));
  const Time began = now, spent = alone_until(way, now, Time(60), Time(100), Time(2'000'000));
  EXPECT_LE(spent.count() * 8, (now - began).count());
}

TEST(FasterWay, IntervalsWithoutRunsDecideNothing) {
  FasterWay way;
  EXPECT_FALSE(way.alone_after_together(0, Time(5), Time(5)));
  EXPECT_TRUE(way.alone_after_alone(0, Time(5), Time(10)));
  EXPECT_TRUE(way.alone_after_together(10, Time(5), Time(15))) << "alone is tried first of all";
}

}  // namespace
}  // namespace carousel::ringbus
