// The wheel against a sorted list.
#include "ringbus/time/event_wheel.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/random_runs.h"

namespace carousel::ringbus {
namespace {

TEST(EventWheel, GivesEventsInOrderOfTimeAndThenOfAddition) {
  std::mt19937 random(static_cast<std::mt19937::result_type>(run_seed()));
  for (int run = 0; run < 20; ++run) {
    EventWheel wheel;
    std::multimap<Cycle, std::uint32_t> expected;  // keeps the order of addition within a time
    std::vector<std::uint32_t> idle;
    for (std::uint32_t thing = 0; thing < 60; ++thing) idle.push_back(thing);
    Cycle now = 0;
    const Cycle reach = Cycle{1} << (1 + random() % 14);
    for (int step = 0; step < 5000; ++step) {
      if (!idle.empty() && (expected.empty() || random() % 3 != 0)) {
        const Cycle at = now + random() % reach;
        wheel.add(now, at, idle.back());
        expected.emplace(at, idle.back());
        idle.pop_back();
      } else if (!expected.empty()) {
        const auto [at, thing] = *expected.begin();
        ASSERT_EQ(wheel.next(), at);
        ASSERT_EQ(wheel.take(), thing);
        expected.erase(expected.begin());
        idle.push_back(thing);
        now = at;
        if (expected.empty()) {
          ASSERT_EQ(wheel.next(), kNever);
          now += random() % 10'000;
        }
      }
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
