// Frames whose times are known in closed form.
#include "ringbus/verdict/foretell.h"

#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {
namespace {

using cycle::CycleResult;

/// A machine that needs `fill` cycles before the first ray completes, `each(i)` cycles for ray i, and `drain` cycles
/// for the last `in_flight` rays, which begin together.
template <class Each>
CycleResult machine(std::uint64_t rays, double fill, const Each& each, double drain = 0, std::uint64_t in_flight = 0) {
  CycleResult out;
  double at = fill;
  for (std::uint64_t i = 0; i < rays; ++i) {
    at += i + in_flight < rays ? each(i) : drain / static_cast<double>(in_flight);
    if (i % 8 == 0) out.progress.push_back({static_cast<Cycle>(at), i + 1, {static_cast<Cycle>(at)}});
    if (i + in_flight + 1 == rays) out.all_begun = {static_cast<Cycle>(at), i + 1, {static_cast<Cycle>(at)}};
  }
  out.cycles = static_cast<Cycle>(at);
  out.uses = {{"shading", 1, out.cycles}};
  return out;
}

template <class Each>
double whole_gain(std::uint64_t rays, double fill, const Each& before, double fill_after, const Each& after) {
  double a = fill, b = fill_after;
  for (std::uint64_t i = 0; i < rays; ++i) a += before(i), b += after(i);
  return a / b - 1;
}

// Times of 1 / 2 and 1 / 1.6 of the base's, with errors of 0.05 and 0.1 each: the first counts four times as much.
TEST(Foretell, TwoEstimatesCountByHowNarrowTheyAre) {
  const auto estimate = [](double time, double error) {
    return Estimate{1 / time - 1, 1 / (time + error) - 1, 1 / (time - error) - 1};
  };
  const Estimate narrow = estimate(0.5, 0.05), wide = estimate(0.625, 0.1), gain = both(narrow, wide);
  const double time = 0.8 * 0.5 + 0.2 * 0.625, error = std::hypot(0.8 * 0.05, 0.2 * 0.1);
  EXPECT_NEAR(gain.value, 1 / time - 1, 1e-12);
  EXPECT_NEAR(gain.low, 1 / (time + error) - 1, 1e-12);
  EXPECT_NEAR(gain.high, 1 / (time - error) - 1, 1e-12);
  EXPECT_LT(error, 0.05) << "two know more than one";
}

TEST(Foretell, FillAndDrainCountOnce) {
  const auto ten = [](std::uint64_t) { return 10.0; };
  const CycleResult pilot = machine(4000, 20000, ten, 9000, 100);
  const Foretelling foretelling({&pilot, 4000}, 100000, 500);
  EXPECT_NEAR(foretelling.cycles().value, 20000 + 9000 + 99900 * 10, 200);
  EXPECT_LT(foretelling.cycles().high / foretelling.cycles().value, 1.001);
}

TEST(Foretell, GainsAreThoseOfTheFrameAndNotOfThePilot) {
  using Each = std::function<double(std::uint64_t)>;
  const Each ten = [](std::uint64_t) { return 10.0; }, five = [](std::uint64_t) { return 5.0; };
  const CycleResult base = machine(4000, 20000, ten), relaxed = machine(4000, 20000, five);
  const Estimate gain = Foretelling({&base, 4000}, 100000, 500).gain({&relaxed, 4000}, 0);
  EXPECT_NEAR(gain.value, whole_gain(100000, 20000, ten, 20000, five), 0.01);  // +96 %; the pilot gains 50 %
  EXPECT_NEAR(gain.low, gain.value, 0.01);
  EXPECT_NEAR(gain.high, gain.value, 0.01);
}

// The first rays are cheap, the rest are dear: a steady state between quarters of completed rays sees another mix.
TEST(Foretell, CheapRaysThatCompleteFirstChangeNothing) {
  using Each = std::function<double(std::uint64_t)>;
  const auto mixed = [](double cheap, double dear, std::uint64_t rays) {
    return Each([=](std::uint64_t i) { return i < rays / 2 ? cheap : dear; });
  };
  const CycleResult base = machine(4000, 1000, mixed(2, 20, 4000)), relaxed = machine(4000, 1000, mixed(1, 20, 4000));
  const Estimate gain = Foretelling({&base, 4000}, 100000, 100).gain({&relaxed, 4000}, 0);
  const double real = whole_gain(100000, 1000, mixed(2, 20, 100000), 1000, mixed(1, 20, 100000));
  EXPECT_NEAR(gain.value, real, 0.01);
  EXPECT_LE(gain.low, real);
  EXPECT_GE(gain.high, real);
}

// Twice the room for shapes: rays take 10 cycles each as before, then ever fewer, down to 4, while it fills.
TEST(Foretell, AMachineThatWarmsGainsWhatItsLaterHalfSays) {
  using Each = std::function<double(std::uint64_t)>;
  const Each ten = [](std::uint64_t) { return 10.0; };
  for (const double rays_to_fill : {300.0, 600.0, 1200.0}) {
    const Each warming = [=](std::uint64_t i) { return 4 + 6 * std::exp(-static_cast<double>(i) / rays_to_fill); };
    const CycleResult base = machine(4000, 0, ten), relaxed = machine(4000, 0, warming);
    const Foretelling foretelling({&base, 4000}, 100000, 100);
    const double real = whole_gain(100000, 0, ten, 0, warming);
    const Estimate without = foretelling.gain({&relaxed, 4000}, 0), gain = foretelling.gain({&relaxed, 4000}, 0, true);
    EXPECT_LT(std::abs(gain.value - real), std::abs(without.value - real) / 2) << rays_to_fill;
    EXPECT_LE(gain.low, real) << rays_to_fill;
    EXPECT_GE(gain.high, real) << rays_to_fill;
    EXPECT_LT(without.high, real) << rays_to_fill;
  }
}

// Blocks that differ at random between the machines: the interval holds the true gain 19 times in 20.
TEST(Foretell, TheIntervalIsAsWideAsTheNoise) {
  using Each = std::function<double(std::uint64_t)>;
  int within = 0;
  double width = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto noisy = [&](double cycles, unsigned seed) {
      auto random = std::make_shared<std::mt19937>(seed);
      auto level = std::make_shared<double>(0.0);
      return Each([=](std::uint64_t i) {
        if (i % 100 == 0) *level = 0.2 * cycles * (static_cast<double>((*random)() % 2001) / 1000 - 1);
        return cycles + *level;
      });
    };
    const auto seed = static_cast<unsigned>(2 * trial + 1);
    const CycleResult base = machine(8000, 0, noisy(11, seed)), relaxed = machine(8000, 0, noisy(10, seed + 1));
    const Estimate gain = Foretelling({&base, 8000}, 1000000, 100).gain({&relaxed, 8000}, 0);
    within += gain.low <= 0.1 && 0.1 <= gain.high;
    width += (gain.high - gain.low) / kTrials;
  }
  EXPECT_GE(within, 180);
  EXPECT_LT(width, 0.12);
}

/// A machine whose rays take as long as their tests, and no test where they are sky; `uses` are those of box units.
CycleResult testing_machine(std::uint64_t rays, const std::function<double(std::uint64_t)>& tests, double each,
                            double sky) {
  CycleResult out;
  double at = 0, done = 0;
  for (std::uint64_t i = 0; i < rays; ++i) {
    done += tests(i);
    at += tests(i) > 0 ? each * tests(i) : sky;
    if (i % 8 == 0) out.progress.push_back({static_cast<Cycle>(at), i + 1, {static_cast<Cycle>(done)}});
  }
  out.cycles = static_cast<Cycle>(at);
  out.uses = {{"box_tests", 1, static_cast<Cycle>(done)}};
  return out;
}

// The pilot has more dear rays than the frame, in other places. What a test takes is the same in both.
TEST(Foretell, TestsAreCountedWhereTheyVaryLess) {
  const auto pilot_tests = [](std::uint64_t i) { return i / 100 % 3 == 0 ? 10.0 : 100.0; };
  const auto frame_tests = [](std::uint64_t i) { return i / 500 % 3 == 0 ? 100.0 : 10.0; };
  const CycleResult pilot = testing_machine(4000, pilot_tests, 2, 0), frame = testing_machine(60000, frame_tests, 2, 0),
                    relaxed = testing_machine(4000, pilot_tests, 1, 0);
  const Foretelling by_rays({&pilot, 4000}, 60000, 100), foretelling({&pilot, 4000}, 60000, 100, &frame);
  EXPECT_TRUE(foretelling.by_tests());
  EXPECT_GT(by_rays.cycles().value, 1.5 * static_cast<double>(frame.cycles));
  EXPECT_NEAR(foretelling.cycles().value / static_cast<double>(frame.cycles), 1, 0.01);
  EXPECT_NEAR(foretelling.busy()[0] / static_cast<double>(frame.uses[0].busy), 1, 0.01);
  EXPECT_NEAR(foretelling.gain({&relaxed, 4000}, 0).value, 1, 0.01);
}

// Every ray takes as long, whether it is sky or needs tests. By its tests the time of the sky would be left out.
TEST(Foretell, RaysAreCountedWhereThereIsSky) {
  const auto tests = [](std::uint64_t i) { return i / 500 % 2 == 0 ? 0.0 : 10.0; };
  const CycleResult pilot = testing_machine(4000, tests, 2, 20), frame = testing_machine(60000, tests, 2, 20);
  const Foretelling foretelling({&pilot, 4000}, 60000, 100, &frame);
  EXPECT_FALSE(foretelling.by_tests());
  EXPECT_NEAR(foretelling.cycles().value / static_cast<double>(frame.cycles), 1, 0.01);
}

TEST(Foretell, TheGainOfAWholeFrameIsMeasured) {
  const auto ten = [](std::uint64_t) { return 10.0; };
  const auto nine = [](std::uint64_t) { return 9.0; };
  const CycleResult base = machine(4000, 300, ten, 900, 30), relaxed = machine(4000, 100, nine, 600, 30);
  const Estimate gain = Foretelling({&base, 4000}, 4000, 500).gain({&relaxed, 4000}, 0.3);
  EXPECT_DOUBLE_EQ(gain.value, static_cast<double>(base.cycles) / static_cast<double>(relaxed.cycles) - 1);
  EXPECT_NEAR(gain.low, gain.value, 0.001);
  EXPECT_NEAR(gain.high, gain.value, 0.001);
}

// Two whole frames of the same picture with other random numbers: the gain of one lies in the interval of the other.
TEST(Foretell, TheIntervalOfAWholeFrameCoversOtherSeeds) {
  int within = 0;
  double width = 0;
  constexpr int kTrials = 200;
  const auto gain_of = [](unsigned seed) {
    const auto noisy = [](double cycles, unsigned of) {
      auto random = std::make_shared<std::mt19937>(of);
      auto level = std::make_shared<double>(0.0);
      return [=](std::uint64_t i) {
        if (i % 100 == 0) *level = 0.2 * cycles * (static_cast<double>((*random)() % 2001) / 1000 - 1);
        return cycles + *level;
      };
    };
    const CycleResult base = machine(8000, 0, noisy(11, 2 * seed)), relaxed = machine(8000, 0, noisy(10, 2 * seed + 1));
    return Foretelling({&base, 8000}, 8000, 100).gain({&relaxed, 8000}, 0);
  };
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const Estimate here = gain_of(2 * trial), there = gain_of(2 * trial + 1);
    within += here.low <= there.value && there.value <= here.high;
    width += (here.high - here.low) / kTrials;
  }
  EXPECT_GE(within, 180);
  EXPECT_LT(width, 0.17);
}

TEST(Foretell, AKnownDeviationWidensTheInterval) {
  const auto ten = [](std::uint64_t) { return 10.0; };
  const CycleResult base = machine(4000, 0, ten);
  const Estimate gain = Foretelling({&base, 4000}, 100000, 500).gain({&base, 4000}, 0.06);
  EXPECT_NEAR(gain.low, -0.0225, 1e-6);  // three eighths of it
  EXPECT_NEAR(gain.high, 0.0225, 1e-6);
}

// Blocks that differ are one error, a known deviation another: together they are their root of squares.
TEST(Foretell, AKnownDeviationAndTheErrorOfBlocksAreIndependent) {
  std::mt19937 random(5);
  const auto noisy = [&](std::uint64_t) { return 5.0 + static_cast<double>(random() % 10); };
  const auto ten = [](std::uint64_t) { return 10.0; };
  const CycleResult base = machine(4000, 0, noisy), relaxed = machine(4000, 0, ten);
  const Foretelling foretelling({&base, 4000}, 100000, 500);
  const auto half = [&](double deviation) {
    const Estimate gain = foretelling.gain({&relaxed, 4000}, deviation);
    return (gain.high - gain.low) / 2;
  };
  const double value = foretelling.gain({&relaxed, 4000}, 0).value, off = 0.75 * 0.06 * (1 + value) * (1 + value) / 2;
  ASSERT_GT(half(0), 0.001);
  EXPECT_NEAR(half(0.06), std::hypot(half(0), off), 1e-9);
}

TEST(SteadyState, LeavesFillAndDrainOut) {
  CycleResult run = machine(
      10000, 5000, [](std::uint64_t) { return 10.0; }, 30000, 500);
  for (auto& sample : run.progress) sample.busy = {8 * sample.completed};  // each ray makes the same work
  run.all_begun->busy = {8 * run.all_begun->completed};
  run.uses[0].busy = 80000;
  const auto steady = steady_state(run, 10000, 400);
  ASSERT_TRUE(steady);
  EXPECT_NEAR(10000 * steady->share / static_cast<double>(steady->cycles), 0.1, 0.003);
}

// FlightHelmet, before issue 16: cheap rays complete first, and a rate of them stood beside a bound of half as much.
TEST(SteadyState, IsNeverAboveTheBound) {
  CycleResult run = machine(10000, 0, [](std::uint64_t i) { return i < 7000 ? 1.0 : 20.0; });
  for (auto& sample : run.progress) sample.busy = {sample.at};  // a class that is always busy: the bound is the rate
  run.all_begun = run.progress[run.progress.size() * 4 / 5];
  const auto steady = steady_state(run, 10000, 100);
  const double bound = 10000 / static_cast<double>(run.cycles);
  if (steady) {
    EXPECT_LE(10000 * steady->share / static_cast<double>(steady->cycles), bound * 1.0001);
  }
}

TEST(SteadyState, AFrameThatOnlyFillsAndDrainsHasNone) {
  const CycleResult run = machine(
      1000, 500, [](std::uint64_t) { return 10.0; }, 3000, 600);
  EXPECT_FALSE(steady_state(run, 1000, 400));
}

}  // namespace
}  // namespace carousel::ringbus
