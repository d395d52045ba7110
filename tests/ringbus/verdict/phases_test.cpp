// Runs whose limiting class changes where it is known.
#include "ringbus/verdict/phases.h"

#include <functional>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

using Each = std::function<double(std::uint64_t)>;
constexpr std::uint64_t kRays = 16000;

cycle::CycleResult machine(const Each& each) {
  cycle::CycleResult out;
  double at = 0;
  for (std::uint64_t i = 0; i < kRays; ++i) {
    at += each(i);
    if (i % 8 == 0) out.progress.push_back({static_cast<Cycle>(at), i + 1, {}});
  }
  out.cycles = static_cast<Cycle>(at);
  return out;
}

/// `before` cycles a ray in the first quarter of the rays, and then `after`.
Each in_two(double before, double after) {
  return [=](std::uint64_t i) { return i < kRays / 4 ? before : after; };
}

std::vector<FramePhase> phases(const Each& base, const std::vector<Each>& relaxed) {
  const cycle::CycleResult all = machine(base);
  std::vector<cycle::CycleResult> others;
  for (const Each& one : relaxed) others.push_back(machine(one));
  std::vector<PilotRun> runs;
  for (const cycle::CycleResult& one : others) runs.push_back({&one, kRays});
  return frame_phases({&all, kRays}, runs);
}

TEST(FramePhases, AreCutWhereAnotherClassGainsMost) {
  // The first class halves the first quarter, which is dear; the second one halves the rest.
  const auto found = phases(in_two(30, 10), {in_two(15, 10), in_two(30, 5)});
  ASSERT_EQ(found.size(), 2);
  EXPECT_EQ(found[0].best, 0);
  EXPECT_DOUBLE_EQ(found[0].end, 0.25);
  EXPECT_NEAR(found[0].time, 0.5, 0.01);
  EXPECT_NEAR(found[0].gain, 1, 0.01);
  EXPECT_EQ(found[1].best, 1);
  EXPECT_DOUBLE_EQ(found[1].begin, 0.25);
  EXPECT_NEAR(found[1].gain, 1, 0.01);
}

TEST(FramePhases, AStretchInWhichNothingGainsHasNoClass) {
  const auto found = phases(in_two(20, 20), {in_two(10, 20)});
  ASSERT_EQ(found.size(), 2);
  EXPECT_EQ(found[0].best, 0);
  EXPECT_EQ(found[1].best, kNoClass);
}

TEST(FramePhases, OneClassThatAlwaysLimitsIsOnePhase) {
  const auto found = phases(in_two(30, 10), {in_two(15, 5), in_two(29, 9)});
  ASSERT_EQ(found.size(), 1);
  EXPECT_EQ(found[0].best, 0);
  EXPECT_EQ(found[0].end, 1);
  EXPECT_DOUBLE_EQ(found[0].time, 1);
  EXPECT_TRUE(phases(in_two(30, 10), {}).empty());
}

// Two classes gain the same but for noise, by which either of them may be ahead in a block.
TEST(FramePhases, NoiseMakesNoPhases) {
  int cut = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const auto noisy = [seed](unsigned which) {
      return [random = std::make_shared<std::mt19937>(7 * seed + which),
              level = std::make_shared<double>(0.0)](std::uint64_t i) {
        if (i % 1000 == 0) *level = 0.1 * (static_cast<double>((*random)() % 2001) / 1000 - 1);
        return 5 * (1 + *level);
      };
    };
    cut += phases(in_two(10, 10), {noisy(1), noisy(2), noisy(3)}).size() > 1;
  }
  EXPECT_LE(cut, 5);
}

}  // namespace
}  // namespace carousel::ringbus
