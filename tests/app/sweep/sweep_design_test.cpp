// The values and points of a sweep: texts of --vary, grids, hypercubes, exclusions.
#include <array>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/sweep/analysis.h"
#include "app/sweep/noise.h"
#include "app/sweep/plan/design.h"
#include "core/system/error.h"

namespace carousel::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> values(const std::string& text) {
  std::vector<std::string> out;
  for (const auto& level : parse_axis(text).levels) out.push_back(level.at(0));
  return out;
}

std::string error_of(const std::string& text) {
  try {
    parse_axis(text);
  } catch (const ConfigError& error) {
    return error.issues().at(0).text();
  }
  return "";
}

TEST(SweepAxis, ReadsListsAndRanges) {
  EXPECT_THAT(values("topology.resources=2,4,8"), ElementsAre("2", "4", "8"));
  EXPECT_THAT(values("topology.resources=1..4"), ElementsAre("1", "2", "3", "4"));
  EXPECT_THAT(values("topology.resources=1..64*4"), ElementsAre("1", "4", "16", "64"));
  EXPECT_THAT(values("topology.resources=8..40+16"), ElementsAre("8", "24", "40"));
  EXPECT_THAT(values("memory.l2_kib=log:64..4096:7"), ElementsAre("64", "128", "256", "512", "1024", "2048", "4096"));
  EXPECT_THAT(values("camera.aperture=0..1:5"), ElementsAre("0", "0.25", "0.5", "0.75", "1"));
  EXPECT_THAT(values("topology.resources=1..4:7"), ElementsAre("1", "2", "3", "4")) << "integers are rounded";
  EXPECT_THAT(values("scene.sky={color: [1, 1, 1]},{strength: 0}"), ElementsAre("{color: [1, 1, 1]}", "{strength: 0}"));
}

TEST(SweepAxis, ReadsPairs) {
  const Axis axis = parse_axis("topology.resources,memory.l2_kib=(2,64),(4,128)");
  EXPECT_THAT(axis.keys, ElementsAre("topology.resources", "memory.l2_kib"));
  EXPECT_THAT(axis.levels, ElementsAre(ElementsAre("2", "64"), ElementsAre("4", "128")));
}

TEST(SweepAxis, RefusesOtherTexts) {
  EXPECT_THAT(error_of("topology.resorces=2"), HasSubstr("did you mean 'topology.resources'?"));
  EXPECT_THAT(error_of("topology.resources"), HasSubstr("expected key.path=values"));
  EXPECT_THAT(error_of("topology.resources=2,,4"), HasSubstr("one of them is empty"));
  EXPECT_THAT(error_of("topology.resources=2,2"), HasSubstr("found 2 twice"));
  EXPECT_THAT(error_of("topology.resources=8..2"), HasSubstr("expected a range"));
  EXPECT_THAT(error_of("topology.resources=1..8*1"), HasSubstr("expected a step"));
  EXPECT_THAT(error_of("memory.l2_kib=log:0..8:3"), HasSubstr("low above 0"));
  EXPECT_THAT(error_of("topology.resources,memory.l2_kib=(2,64),4"), HasSubstr("expected 2 values in brackets"));
}

TEST(SweepAxis, ExcludesByConditions) {
  const std::vector<Axis> axes{parse_axis("topology.resources=1..8"), parse_axis("topology.shape=ring,bus")};
  const Exclusion exclusion = parse_exclusion("topology.resources>=4, topology.shape=bus", axes);
  EXPECT_TRUE(exclusion.holds({{"topology.resources", "4"}, {"topology.shape", "bus"}}));
  EXPECT_FALSE(exclusion.holds({{"topology.resources", "3"}, {"topology.shape", "bus"}}));
  EXPECT_FALSE(exclusion.holds({{"topology.resources", "8"}, {"topology.shape", "ring"}}));
  EXPECT_THROW(parse_exclusion("memory.l2_kib=4", axes), ConfigError);
  EXPECT_THROW(parse_exclusion("nonsense", axes), ConfigError);
}

TEST(SweepDesign, GridHasEveryCombinationOnce) {
  const std::vector<Axis> axes{parse_axis("topology.resources=2,4,8"), parse_axis("memory.l2_kib=64,128"),
                               parse_axis("packets.rays,collections.ready=(8,8),(16,16)")};
  const std::vector<Choice> points = grid(axes);
  EXPECT_EQ(points.size(), 12u);
  EXPECT_EQ(std::set<Choice>(points.begin(), points.end()).size(), 12u);
  for (const Choice& point : points) {
    ASSERT_EQ(point.size(), 4u);
    EXPECT_EQ(point[2].second, point[3].second) << "paired keys vary together";
  }
}

TEST(SweepDesign, HypercubeIsStratifiedAndRepeatsWithItsSeed) {
  const std::vector<Axis> axes{parse_axis("camera.aperture=0..1:2"), parse_axis("memory.l2_kib=log:1..1000000:2"),
                               parse_axis("topology.resources=1,2,4,8")};
  constexpr std::size_t kPoints = 20;
  const std::vector<Choice> cube = latin_hypercube(axes, kPoints, 7);
  EXPECT_EQ(cube, latin_hypercube(axes, kPoints, 7));
  EXPECT_NE(cube, latin_hypercube(axes, kPoints, 8));
  std::set<int> linear, logarithmic;
  std::multiset<std::string> listed;
  for (const Choice& point : cube) {
    linear.insert(static_cast<int>(std::stod(point[0].second) * kPoints));
    logarithmic.insert(static_cast<int>(std::log10(std::stod(point[1].second)) / 6 * kPoints));
    listed.insert(point[2].second);
  }
  EXPECT_EQ(linear.size(), kPoints) << "each twentieth of the range has one point";
  EXPECT_GE(logarithmic.size(), kPoints - 3) << "the lowest strata hold no two integers";
  for (const char* value : {"1", "2", "4", "8"}) EXPECT_EQ(listed.count(value), 5u);
}

SweepRows table(const std::vector<std::array<double, 4>>& rows) {  // keys a and b, results x and y
  SweepRows out{{"a", "b"}, {{"x", "x"}, {"y", "y", true}}, {}};
  for (const auto& [a, b, x, y] : rows) {
    SweepRow row;
    row.point.keys = {{"a", std::to_string(int(a))}, {"b", std::to_string(int(b))}};
    row.finished = true;
    row.results = {x, y};
    out.rows.push_back(row);
  }
  return out;
}

TEST(SweepAnalysis, FindsTheParetoFront) {
  const SweepRows rows = table({{1, 1, 3, 9}, {1, 2, 1, 1}, {2, 1, 2, 5}, {2, 2, 3, 8}, {3, 1, 4, 9}});
  EXPECT_THAT(pareto_front(rows, parse_goals(rows, "x,y")), ElementsAre(1, 2, 0));
  EXPECT_THAT(pareto_front(rows, parse_goals(rows, "x,min:y")), ElementsAre(1));
  EXPECT_THROW(parse_goals(rows, "x"), ConfigError);
  EXPECT_THROW(parse_goals(rows, "x,z"), ConfigError);
}

// x = 10 + effect of a + effect of b: an additive model finds them exactly, with points missing as well.
TEST(SweepAnalysis, FindsTheEffectsOfAnAdditiveModel) {
  const auto x = [](int a, int b) { return 10 + (a == 1 ? -2.0 : a == 2 ? 0.5 : 1.5) + (b == 1 ? 3.0 : -3.0); };
  std::vector<std::array<double, 4>> cells;
  for (int a = 1; a <= 3; ++a)
    for (int b = 1; b <= 2; ++b) cells.push_back({double(a), double(b), x(a, b), 0});
  for (const bool all : {true, false}) {
    if (!all) cells.erase(cells.begin() + 2);
    const std::vector<MainEffect> effects = main_effects(table(cells), 0);
    ASSERT_EQ(effects.size(), 2u);
    const auto& a = effects[0].levels;
    EXPECT_NEAR(a[1].effect - a[0].effect, 2.5, 1e-6);
    EXPECT_NEAR(a[2].effect - a[1].effect, 1.0, 1e-6);
    EXPECT_NEAR(effects[1].levels[1].effect - effects[1].levels[0].effect, -6, 1e-6);
    ASSERT_TRUE(a[0].half_width.has_value());
    EXPECT_NEAR(*a[0].half_width, 0, 1e-6);
  }
}

// Two levels, two points each, values 1, 3 and 5, 9: residuals -1, 1, -2, 2, so s^2 = 10 / 2, and the mean of two of
// four differs from the mean of all with the variance s^2 (1/2 - 1/4); Student's t for two degrees is 4.3027.
TEST(SweepAnalysis, IntervalsAreStudents) {
  const std::vector<MainEffect> effects =
      main_effects(table({{1, 1, 1, 0}, {1, 1, 3, 0}, {2, 1, 5, 0}, {2, 1, 9, 0}}), 0);
  ASSERT_EQ(effects.size(), 1u) << "a key with one value has no effect";
  EXPECT_NEAR(effects[0].levels[0].effect, -2.5, 1e-9);
  EXPECT_NEAR(effects[0].levels[0].half_width.value_or(0), 4.30265 * std::sqrt(5.0 / 4), 1e-4);
}

SweepRows with_noise(const std::vector<std::pair<double, double>>& cycles_and_noise) {
  SweepRows out;
  out.keys = {"topology.resources"};
  out.columns = {{"cycles", "engine.cycles"}, {kNoiseColumn, "cycle_noise.fraction"}, {"bytes", "x"}};
  for (const auto& [cycles, noise] : cycles_and_noise) {
    SweepRow& row = out.rows.emplace_back();
    row.finished = true;
    row.point.keys = {{"topology.resources", std::to_string(out.rows.size())}};
    row.results = {cycles, noise > 0 ? nlohmann::ordered_json(noise) : nlohmann::ordered_json(), cycles};
  }
  return out;
}

TEST(SweepNoise, TiesAreWithinTheNoiseOfTheReports) {
  const SweepRows rows = with_noise({{104, 0.05}, {100, 0.05}, {106, 0.05}, {104, 0.001}, {103, 0}});
  EXPECT_THAT(ties_with_best(rows, {0, false}), ElementsAre(true, false, false, false, true));
  EXPECT_THAT(ties_with_best(rows, {0, true}), ElementsAre(true, false, false, true, true)) << "106 is the best";
  EXPECT_THAT(ties_with_best(rows, {2, false}), testing::Each(false)) << "bytes do not follow from the cycles";
}

// Four seeds of two machines, each with a deviation of 0.8 %: 2.447 (t, six degrees of freedom) x root 2 x 0.8 % = 2.8
// %.
TEST(SweepNoise, TiesAreWithinTheNoiseOfRepeatedPoints) {
  SweepRows rows = with_noise({{99, 0}, {100, 0}, {100, 0}, {101, 0}, {103, 0}, {104, 0}, {104, 0}, {105, 0}});
  rows.keys = {"topology.resources", "image.seed"};
  for (std::size_t i = 0; i < 8; ++i)
    rows.rows[i].point.keys = {{"topology.resources", i < 4 ? "1" : "2"}, {"image.seed", std::to_string(i % 4)}};
  EXPECT_THAT(ties_with_best(rows, {2, false}), ElementsAre(false, true, true, true, false, false, false, false));
  rows.rows[4].results[2] = 101.5;
  EXPECT_TRUE(ties_with_best(rows, {2, false})[4]);
}

}  // namespace
}  // namespace carousel::app
