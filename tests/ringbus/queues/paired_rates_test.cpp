// The rule by which stress claims one of two candidates to be faster, on pairs made up for it.
#include "ringbus/stress/paired_rates.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus::stress {
namespace {

/// Pairs of rates about 1000 times a drift, the first `advantage` times the second but for noise.
std::vector<RatePair> pairs_of(std::size_t count, double advantage, double noise, std::uint64_t seed,
                               double drift = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss(0, noise);
  std::vector<RatePair> pairs;
  double level = 1000;
  for (std::size_t i = 0; i < count; ++i, level *= drift)
    pairs.push_back({level * advantage * std::exp(gauss(random)), level * std::exp(gauss(random))});
  return pairs;
}

double claimed(std::size_t count, double advantage, double noise, double drift = 1) {
  constexpr int kTrials = 4000;
  int claims = 0;
  for (int seed = 0; seed < kTrials; ++seed) {
    const PairedDifference d =
        compare_pairs(pairs_of(count, advantage, noise, static_cast<std::uint64_t>(seed), drift));
    claims += d.first_is_faster || d.second_is_faster;
  }
  return static_cast<double>(claims) / kTrials;
}

TEST(PairedRates, EqualCandidatesAreSeldomToldApart) {
  // At most 1 % by the interval, and three standard errors of 4,000 trials.
  for (const std::size_t pairs : {8, 9, 12, 13, 20, 40})
    for (const double noise : {0.001, 0.1, 1.0}) EXPECT_LE(claimed(pairs, 1, noise), 0.01 + 0.005) << pairs << noise;
}

TEST(PairedRates, ALargeDifferenceIsClaimedAndASmallOneIsNot) {
  EXPECT_GT(claimed(12, 1.30, 0.05), 0.99);
  EXPECT_LT(claimed(12, 1.01, 0.10), 0.05);
}

// Every first run is slower than some second one, and still each pair shows the difference.
TEST(PairedRates, LoadThatFallsOnBothRunsOfAPairDoesNotHideADifference) {
  const PairedDifference d = compare_pairs(pairs_of(12, 1.2, 0.01, 1, 0.7));
  EXPECT_TRUE(d.first_is_faster);
  EXPECT_EQ(d.wins, 12u);
  EXPECT_NEAR(d.ratio, 1.2, 0.02);
}

// The old rule took the best cell's worst repetition above the worst cell's best for no accident: three repetitions of
// two equal candidates are in such an order in one of ten cases, and the extremes of 21 candidates much oftener.
TEST(PairedRates, ThreeRepetitionsShowNothing) {
  const PairedDifference d = compare_pairs(std::vector<RatePair>{{9, 1}, {8, 1}, {7, 1}});
  EXPECT_EQ(d.pairs, 3u);
  EXPECT_EQ(d.wins, 3u);
  EXPECT_FALSE(d.first_is_faster);
  EXPECT_FALSE(d.second_is_faster);
}

TEST(PairedRates, OneOfTwelvePairsMayDisagreeAndTwoMayNot) {
  std::vector<RatePair> pairs(12, RatePair{11, 10});
  pairs[3] = {10, 11};
  EXPECT_TRUE(compare_pairs(pairs).first_is_faster);  // 13 of 4,096 orders of wins are as clear
  pairs[7] = {10, 11};
  EXPECT_FALSE(compare_pairs(pairs).first_is_faster);
}

TEST(PairedRates, TheSlowerIsNamedAsWell) {
  const PairedDifference d = compare_pairs(std::vector<RatePair>(8, RatePair{1, 2}));
  EXPECT_TRUE(d.second_is_faster);
  EXPECT_EQ(d.ratio, 0.5);
  EXPECT_EQ(d.most, 0.5);
}

TEST(PairedRates, EqualRatesAndRunsThatFailedAreNoWins) {
  EXPECT_FALSE(compare_pairs(std::vector<RatePair>(20, RatePair{5, 5})).first_is_faster);
  EXPECT_EQ(compare_pairs(std::vector<RatePair>{{0, 1}, {1, 0}}).pairs, 0u);
  EXPECT_EQ(compare_pairs({}).ratio, 1);
}

}  // namespace
}  // namespace carousel::ringbus::stress
