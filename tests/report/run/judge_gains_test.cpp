#include "report/run/judge_gains.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/relaxation.h"
#include "report/run/part_groups.h"

namespace carousel::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BottleneckGain gain(const std::string& name, double value, double low, double high) {
  return {name, "twice " + name, {name + "=2"}, 100 * (1 + value), value, low, high};
}

TEST(JudgeGains, NamesTheGreatestGainWithItsInterval) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.48, 0.45, 0.51), gain("boxes", 0.1, 0.08, 0.12)}});
  EXPECT_EQ(b.limits, "shading");
  EXPECT_THAT(b.rivals, IsEmpty());
  EXPECT_EQ(b.verdict,
            "shading: twice shading gains +48.0 % (+45.0 to +51.0 %), next is boxes with +10.0 % (+8.0 to +12.0 %)");
}

TEST(JudgeGains, NamesNothingInsideTheNoise) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.07, -0.16, 0.3), gain("boxes", 0.01, -0.03, 0.05)}});
  EXPECT_THAT(b.limits, IsEmpty());
  EXPECT_THAT(b.verdict, HasSubstr("no class of parts can be told to limit it"));
  EXPECT_THAT(b.verdict, HasSubstr("which may be noise"));
}

TEST(JudgeGains, SaysThatNothingLimitsWhereNothingGains) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.03, -0.01, 0.07), gain("boxes", 0.01, -0.03, 0.05)}});
  EXPECT_THAT(b.verdict, HasSubstr("no class of parts limits it alone"));
}

TEST(JudgeGains, SaysWhichClassesItCannotTellApart) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.2, 0.15, 0.25), gain("boxes", 0.18, 0.12, 0.24),
                                              gain("triangles", 0.11, 0.09, 0.13), gain("links", 0, -0.01, 0.01)}});
  EXPECT_EQ(b.limits, "shading");
  EXPECT_THAT(b.rivals, ElementsAre("boxes"));
  EXPECT_THAT(b.verdict, HasSubstr("not to be told apart from it: boxes with +18.0 %"));
}

TEST(JudgeGains, ATieIsToldAsAGroupWithWhatItHasInCommon) {
  Bottleneck found{.gains = {gain("memory_latency", 0.2, 0.15, 0.25), gain("l2_size", 0.18, 0.12, 0.24),
                             gain("box_tests", 0.1, 0.05, 0.14)}};
  const Bottleneck b = judge_gains(found);
  EXPECT_EQ(b.group, "memory");
  EXPECT_EQ(
      b.verdict,
      "memory (memory_latency or l2_size): not to be told apart; memory_latency: twice memory_latency gains +20.0 % "
      "(+15.0 to +25.0 %); then l2_size with +18.0 % (+12.0 to +24.0 %)");
  found.gains[2].high = 0.2;
  EXPECT_EQ(judge_gains(found).group, "") << "testers are no memory";
  found.gains[1].high = found.gains[2].high = 0.1;
  EXPECT_EQ(judge_gains(found).group, "") << "nothing is as good";
}

TEST(JudgeGains, EachClassOfTheSearchHasAGroup) {
  std::vector<Config> machines(4);
  machines[1].testers.simt.warp = 8;
  machines[2].bundles.size = 4;
  machines[3].topology.shape = TopologyShape::kCentral;
  machines[3].topology.form = CentralForm::kDistributor;
  std::set<std::string> names;
  for (const Config& machine : machines)
    for (const Relaxation& one : relaxations(machine, [](const std::string&) { return true; })) names.insert(one.part);
  EXPECT_GT(names.size(), 40u);
  for (const std::string& name : names) EXPECT_NE(group_of(name), "") << name;
}

TEST(JudgeGains, OfManyRivalsItShowsThree) {
  Bottleneck found;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) found.gains.push_back(gain(name, 0.2, 0.1, 0.3));
  const Bottleneck b = judge_gains(found);
  EXPECT_EQ(b.rivals.size(), 5u);
  EXPECT_THAT(b.verdict, HasSubstr("d with +20.0 % (+10.0 to +30.0 %) and 2 more"));
}

TEST(JudgeGains, AGainInsideTheNoiseMayStillBeARival) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.2, -0.1, 0.5), gain("boxes", 0.18, 0.12, 0.24)}});
  EXPECT_EQ(b.limits, "boxes");
  EXPECT_THAT(b.rivals, ElementsAre("shading"));
}

TEST(JudgeGains, ExactGainsHaveNoInterval) {
  const Bottleneck b = judge_gains({.gains = {gain("shading", 0.48, 0.48, 0.48)}});
  EXPECT_EQ(b.verdict, "shading: twice shading gains +48.0 %");
}

TEST(JudgeGains, SaysThatItWasInterrupted) {
  const Bottleneck b = judge_gains({.complete = false});
  EXPECT_THAT(b.limits, IsEmpty());
  EXPECT_EQ(b.verdict, "not found out: the search was interrupted");
}

TEST(JudgeGains, SaysThatTheFrameIsTooSmall) {
  const Bottleneck b = judge_gains({.frame_too_small = FrameTooSmall{12000, 8192, 0.31, false, 36000}});
  EXPECT_THAT(b.limits, IsEmpty());
  EXPECT_EQ(b.verdict,
            "not found out: 12,000 paths for 8,192 ray slots mostly fill and drain the machine (31 % of the rays lie "
            "between); from some 36,000 paths on, or with fewer slots, it can be said");
}

TEST(JudgeGains, AClassOfAGroupIsARivalAndNotNamed) {
  Bottleneck found{.gains = {gain("links", 0.5, 0.4, 0.6), gain("boxes", 0.3, 0.2, 0.4), gain("ports", 0, 0, 0.25)}};
  found.gains[0].together = 3;
  found.gains[2].together = 0;
  const Bottleneck b = judge_gains(found);
  EXPECT_EQ(b.limits, "boxes");
  EXPECT_THAT(b.rivals, ElementsAre("links", "ports"));
}

TEST(JudgeGains, SaysWhatWasNotTried) {
  Bottleneck found{.gains = {gain("boxes", 0.3, 0.2, 0.4)}};
  found.untried = {{"shading", "twice shading.workers", "shading.workers: expected 1 to 256, found 400"}};
  EXPECT_EQ(judge_gains(found).verdict,
            "boxes: twice boxes gains +30.0 % (+20.0 to +40.0 %); not tried: shading (shading.workers: expected 1 to "
            "256, found 400)");
}

TEST(JudgeGains, SaysThatASearchWouldTakeTooLong) {
  const Bottleneck b = judge_gains({.frame_too_small = FrameTooSmall{768, 64, 0.8, true, 3200, "shading", 0.9}});
  EXPECT_THAT(b.limits, IsEmpty());
  EXPECT_EQ(
      b.verdict,
      "not found out: 768 paths for 64 ray slots are too few for a search that takes no longer than the run; from "
      "some 3,200 paths on, or with fewer slots, it can be said; shading was the busiest part, 90 % of the time");
}

TEST(JudgeGains, OfColdCachesItSaysWhatMayGainMostWhenTheyAreWarm) {
  const Bottleneck b = judge_gains({.cold_caches = ColdCaches{1000, 460, "boxes"},
                                    .gains = {gain("memory", 0.48, 0.45, 0.51), gain("boxes", 0.4, 0.3, 0.5)}});
  EXPECT_EQ(b.limits, "memory");
  EXPECT_THAT(b.rivals, ElementsAre("boxes"));
  EXPECT_EQ(b.verdict,
            "memory: twice memory gains +48.0 % (+45.0 to +51.0 %); not to be told apart from it: boxes with +40.0 % "
            "(+30.0 to +50.0 %); 46 % of the lines that memory reads are read for the first time, and memory gains "
            "less in a larger picture, where boxes may gain most");
}

TEST(JudgeGains, NamesMemoryThatWouldGainMostWithoutFirstReads) {
  const Bottleneck b = judge_gains({.cold_caches = ColdCaches{1000, 260, "memory"},
                                    .gains = {gain("memory", 0.48, 0.45, 0.51), gain("boxes", 0.1, 0.05, 0.15)}});
  EXPECT_EQ(b.limits, "memory");
  EXPECT_EQ(b.verdict,
            "memory: twice memory gains +48.0 % (+45.0 to +51.0 %), next is boxes with +10.0 % (+5.0 to +15.0 %); 26 % "
            "of the lines that memory reads are read for the first time, and memory gains less in a larger picture");
}

TEST(JudgeGains, OfColdCachesNobodyMayKnowWhatGainsMostWhenTheyAreWarm) {
  const Bottleneck b = judge_gains({.cold_caches = ColdCaches{1000, 460}, .gains = {gain("memory", 0.48, 0.45, 0.51)}});
  EXPECT_EQ(b.limits, "memory");
  EXPECT_EQ(b.verdict,
            "memory: twice memory gains +48.0 % (+45.0 to +51.0 %); 46 % of the lines that memory reads are read for "
            "the first time, and memory gains less in a larger picture, where another class may gain most");
}

// Memory gains a little more than boxes while caches are cold. In a larger picture boxes go on to gain as much.
TEST(JudgeGains, OfATieItNamesTheClassThatLasts) {
  const auto fades = [](const std::string& part) { return part == "memory"; };
  Bottleneck found{.gains = {gain("memory", 0.22, 0.16, 0.28), gain("boxes", 0.2, 0.14, 0.26)}};
  EXPECT_EQ(judge_gains(found, fades).limits, "boxes");
  EXPECT_EQ(judge_gains(found).limits, "memory");
  found.gains[0].gain += 0.02;
  EXPECT_EQ(judge_gains(found, fades).limits, "memory");
}

// A class that is likely to gain gets a name, although chance may have made its gain. A class that is not gets none.
TEST(JudgeGains, SaysThatAClassProbablyLimits) {
  const Bottleneck b = judge_gains({.gains = {gain("boxes", 0.18, -0.06, 0.42)}});
  EXPECT_EQ(b.limits, "boxes");
  EXPECT_EQ(b.verdict, "probably boxes: twice boxes gains +18.0 % (-6.0 to +42.0 %)");
  EXPECT_THAT(judge_gains({.gains = {gain("boxes", 0.04, 0.02, 0.06)}}).limits, IsEmpty());
}

TEST(JudgeGains, SaysThatThePilotIsNotLikeTheRun) {
  const Bottleneck b = judge_gains({.unlike = "boxes are busy 10 % of its time, and 40 % of the run's"});
  EXPECT_EQ(b.verdict,
            "not found out: the pilot is not like the run: boxes are busy 10 % of its time, and 40 % of the run's");
}

}  // namespace
}  // namespace carousel::report
