// Readings of counters that grow at any time, against sums over intervals of known length.
#include "ringbus/results/counter_samples.h"

#include <random>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

/// A counter and a level that change at random times.
struct Story {
  std::vector<std::uint64_t> times, growth, levels;  ///< a level holds from its time on
  std::uint64_t end = 0;

  Story(std::uint32_t seed, std::uint64_t longest_pause) {
    std::mt19937 random(seed);
    for (int i = 0; i < 400; ++i) {
      end += random() % (longest_pause + 1);
      times.push_back(end);
      growth.push_back(random() % 5);
      levels.push_back(random() % 7);
    }
    end += 1 + random() % 3;
  }
};

struct Read {
  std::uint64_t interval = 0;
  std::vector<std::uint64_t> grown, held;
};

Read read(const Story& story, std::size_t most) {
  CounterSamples samples(most, 2);
  LevelSum held;
  std::uint64_t counter = 0, level = 0;
  const auto row = [&](std::uint64_t at, std::span<std::uint64_t> out) {
    out[0] = counter;
    out[1] = held.at(at, level);
  };
  for (std::size_t i = 0; i < story.times.size(); ++i) {
    samples.until(story.times[i], row);
    held.hold(story.times[i], level);
    counter += story.growth[i];
    level = story.levels[i];
  }
  samples.close(story.end, row);
  Read out{samples.interval(), {}, {}};
  out.grown.resize((samples.end() + out.interval - 1) / out.interval);
  out.held.resize(out.grown.size());
  samples.add_to(out.grown, out.interval, 0);
  samples.add_to(out.held, out.interval, 1);
  return out;
}

TEST(CounterSamples, AreTheSumsOverIntervals) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const Story story(seed, seed % 3 == 0 ? 1 : seed % 3 == 1 ? 40 : 9000);
    const std::size_t most = 2 + seed % 40;
    const Read got = read(story, most);
    SCOPED_TRACE(seed);
    ASSERT_LE(got.grown.size(), most);
    EXPECT_GE(2 * got.grown.size() + 2, std::min<std::size_t>(most, story.end));
    std::vector<std::uint64_t> grown(got.grown.size()), held(got.grown.size());
    for (std::size_t i = 0; i < story.times.size(); ++i) {
      grown[story.times[i] / got.interval] += story.growth[i];
      const std::uint64_t until = i + 1 < story.times.size() ? story.times[i + 1] : story.end;
      for (std::uint64_t t = story.times[i]; t < until;) {
        const std::uint64_t border = std::min(until, (t / got.interval + 1) * got.interval);
        held[t / got.interval] += story.levels[i] * (border - t);
        t = border;
      }
    }
    EXPECT_EQ(got.grown, grown);
    EXPECT_EQ(got.held, held);
  }
}

// Parts whose last events lie apart are read at the same times, since only the end counts.
TEST(CounterSamples, OfAPartThatEndsEarlyHaveTheSameTimes) {
  CounterSamples early(64, 1), late(64, 1);
  const auto nothing = [](std::uint64_t, std::span<std::uint64_t> row) { row[0] = 7; };
  for (std::uint64_t t = 0; t < 100'000; t += 17) late.until(t, nothing);
  early.until(3, nothing);
  early.close(100'000, nothing);
  late.close(100'000, nothing);
  EXPECT_EQ(early.interval(), late.interval());
  EXPECT_EQ(early.end(), 100'000u);
  EXPECT_EQ(late.end(), 100'000u);
}

TEST(CounterSamples, ReadNothingIfNoneAreWanted) {
  CounterSamples none;
  EXPECT_FALSE(none.due(1'000'000'000));
  none.close(10, [](std::uint64_t, std::span<std::uint64_t>) { FAIL(); });
}

}  // namespace
}  // namespace carousel::ringbus
