#include "report/accuracy/accuracy.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/accuracy/accuracy_plot.h"

namespace carousel::report {
namespace {

AccuracyRow row(const std::string& triangle, double time, std::uint64_t wrong, bool safe) {
  AccuracyRow r;
  r.triangle = triangle, r.box = "box", r.transform = "two_step";
  r.ns_per_ray = {time, time, time};
  r.scene.rays = 100;
  r.scene.missed = wrong;
  r.safe = safe;
  return r;
}

TEST(AccuracyFrontier, HoldsWhatNothingBeatsInBoth) {
  std::vector<AccuracyRow> rows{row("fast", 10, 5, false), row("slow", 30, 0, true),    row("slower", 40, 0, true),
                                row("bad", 20, 7, false),  row("middle", 20, 2, false), row("even", 20, 2, false)};
  mark_frontier(rows);
  std::vector<std::string> names;
  for (const AccuracyRow& r : rows)
    if (r.frontier) names.push_back(r.triangle);
  EXPECT_THAT(names, testing::ElementsAre("fast", "slow", "middle", "even"));
}

TEST(AccuracyVerdict, NamesTheFastestSafeLevelAndWhatItCosts) {
  const std::vector<AccuracyRow> rows{row("fast", 10, 5, false), row("slower", 40, 0, true), row("slow", 30, 0, true)};
  EXPECT_THAT(accuracy_verdict(rows),
              testing::HasSubstr("slow + box + two_step at 30 ns a ray, +200 % over the fastest"));
  EXPECT_THAT(accuracy_verdict({row("fast", 10, 5, false)}), testing::HasSubstr("No combination is safe"));
  EXPECT_THAT(accuracy_verdict({row("fast", 10, 0, true)}), testing::HasSubstr("also the fastest"));
  EXPECT_EQ(accuracy_verdict({}), "");
}

TEST(AccuracySlope, IsThatOfAPowerLaw) {
  std::vector<SamplingRow> rows;
  for (const std::uint64_t n : {1, 4, 16, 64}) rows.push_back({n, 3 / std::sqrt(double(n)), 0});
  EXPECT_NEAR(log_log_slope(rows), -0.5, 1e-12);
  rows.push_back({256, 0, 0});  // no error at all has no logarithm
  EXPECT_NEAR(log_log_slope(rows), -0.5, 1e-12);
  EXPECT_EQ(log_log_slope({{4, 1, 0}}), 0);
}

TEST(AccuracyPlot, HasADotForEachRow) {
  Accuracy accuracy;
  accuracy.rows = {row("fast", 10, 5, false), row("slow", 30, 0, true)};
  mark_frontier(accuracy.rows);
  const std::string svg = accuracy_plot(accuracy);
  std::size_t dots = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++dots;
  EXPECT_EQ(dots, 2u);
  EXPECT_THAT(svg, testing::HasSubstr("slow + box + two_step"));
  accuracy.rows.clear();
  EXPECT_THAT(accuracy_plot(accuracy), testing::EndsWith("</svg>\n"));
}

}  // namespace
}  // namespace carousel::report
