#include <gtest/gtest.h>

#include "report/compare/comparison.h"
#include "report/html/studies/compare_page.h"

namespace carousel::report {
namespace {

using Json = nlohmann::ordered_json;

Json report(double cycles, const char* hits = "aa", std::int64_t resources = 4) {
  return {
      {"config", {{"engine", {{"kind", "cycle"}, {"threads", cycles}}}, {"topology", {{"resources", resources}}}}},
      {"engine", {{"cycles", cycles}, {"deterministic", true}}},
      {"throughput", {{"whole", {{"rays_per_kilocycle", 1000 / cycles}}}}},
      {"rays", {{"completed", 10}}},
      {"resources",
       {{{"units", {{"box", {{"busy", 30}, {"idle", 10}}}}}}, {{"units", {{"box", {{"busy", 10}, {"idle", 50}}}}}}}},
      {"bytes", {{{"what", "packets"}, {"from", "a"}, {"to", "b"}, {"bytes", 4 * cycles}}}},
      {"area", {{"units_mm2", 2.5}}},
      {"digest", {{"hits", hits}, {"image", "ii"}}},
      {"host", {{"rays_per_second", cycles}}}};
}

const ComparedRow* find(const Comparison& c, const std::string& section, const std::string& row) {
  for (const ComparedSection& s : c.sections)
    for (const ComparedRow& r : s.rows)
      if (s.name == section && r.name == row) return &r;
  return nullptr;
}

TEST(CompareRuns, EqualReportsAreIdenticalWhateverTheHost) {
  Json other = report(100);
  other["host"]["rays_per_second"] = 1;
  other["config"]["engine"]["threads"] = 7;
  const Comparison c = compare_runs({{"a", report(100)}, {"b", other}});
  EXPECT_TRUE(c.identical);
  EXPECT_EQ(comparison_table(c, false), "identical\n");
}

// Before issue 45 the table said "0 keys differ" where the pattern hid the key.
TEST(CompareRuns, CountsTheKeysThatThePatternHides) {
  const auto table = [](const std::string& only) {
    return comparison_table(compare_runs({{"a", report(100)}, {"b", report(90, "aa", 8)}}, only), true);
  };
  EXPECT_NE(table("").find("configuration  1 key differs\n"), std::string::npos);
  EXPECT_NE(table("resources").find("configuration  1 key differs\n"), std::string::npos);
  EXPECT_NE(table("whole run").find("configuration  1 key differs, hidden by --only\n"), std::string::npos);
  EXPECT_NE(table("whole run").find("values that differ are hidden by --only\n"), std::string::npos);
  const Json json = comparison_json(compare_runs({{"a", report(100)}, {"b", report(90, "aa", 8)}}, "whole run"), true);
  EXPECT_EQ(json["keys_hidden"], 1);
  EXPECT_TRUE(json["configuration"].empty());
}

TEST(CompareRuns, DoesNotTellRunsApartWithinTheNoiseOfTheirCycles) {
  const auto with_noise = [](double cycles, double noise) {
    Json out = report(cycles);
    if (noise > 0) out["cycle_noise"]["fraction"] = noise;
    return out;
  };
  const auto within = [&](double noise_of_a, double cycles_of_b, double noise_of_b) {
    return compare_runs({{"a", with_noise(100, noise_of_a)}, {"b", with_noise(cycles_of_b, noise_of_b)}})
        .within_noise.at(1);
  };
  EXPECT_EQ(within(0.05, 104, 0), 0.05) << "one knows it";
  EXPECT_EQ(within(0, 96, 0.05), 0.05);
  EXPECT_FALSE(within(0.05, 106, 0));
  EXPECT_FALSE(within(0, 104, 0)) << "nobody knows it";
  EXPECT_TRUE(within(0.01, 104, 0.07)) << "the root of the mean of both squares is 0.05";
  EXPECT_FALSE(within(0.01, 106, 0.07));
  const Comparison c = compare_runs({{"a", with_noise(100, 0.05)}, {"b", with_noise(104, 0)}});
  const std::string table = comparison_table(c, false);
  EXPECT_NE(table.find("noise          B is not told from A"), std::string::npos) << table;
  EXPECT_NE(table.find("~x1.04"), std::string::npos) << table;
  EXPECT_EQ(comparison_json(c, false)["within_noise"], Json({nullptr, 0.05}));
}

TEST(CompareRuns, GivesValuesAndRatios) {
  const Comparison c = compare_runs({{"a", report(100)}, {"b", report(50, "bb", 8)}, {"c", report(200)}});
  EXPECT_EQ(c.same_hits, (std::vector<bool>{true, false, true}));
  EXPECT_EQ(c.same_picture, (std::vector<bool>{true, true, true}));
  const ComparedRow* length = find(c, "throughput", "length");
  ASSERT_NE(length, nullptr);
  EXPECT_EQ(length->ratios, (std::vector<std::optional<double>>{1, 0.5, 2}));
  const ComparedRow* box = find(c, "cycles of the test units", "box busy");
  ASSERT_NE(box, nullptr);
  EXPECT_DOUBLE_EQ(*box->values[0], 0.4);
  const ComparedRow* bytes = find(c, "bytes", "packets, a to b");
  ASSERT_NE(bytes, nullptr);
  EXPECT_DOUBLE_EQ(*bytes->values[1], 20);
  EXPECT_NE(find(c, "area", "units_mm2"), nullptr);
  EXPECT_EQ(find(c, "energy", "units_mm2"), nullptr);
  ASSERT_EQ(c.configuration.size(), 1u);
  EXPECT_EQ(c.configuration[0].name, "topology.resources");
  EXPECT_EQ(c.configuration[0].texts, (std::vector<std::string>{"4", "8", "4"}));
}

TEST(CompareRuns, PrintsCountsInGroupsAndAVerdictAFactALine) {
  Json a = report(100), b = report(158'000);
  a["bottleneck"]["verdict"] = "not found out: 1 paths for 8,192 ray slots; from some 66,000 paths on it can be said";
  const std::string table = comparison_table(compare_runs({{"a", a}, {"b", b}}), false);
  EXPECT_NE(table.find("verdict        A  not found out: 1 path for 8,192 ray slots\n"
                       "                  from some 66,000 paths on it can be said\n"),
            table.npos)
      << table;
  EXPECT_NE(table.find("158,000"), table.npos) << table;
  EXPECT_NE(table.find("x1,580"), table.npos) << table;
  EXPECT_EQ(table.find("e+0"), table.npos) << table;
}

TEST(ComparePage, NamesUsesAsThePageOfARunAndDrawsOnlyWhatDiffers) {
  const auto page = [](std::uint64_t cycles) {
    return html::compare_page(compare_runs({{"a", report(100)}, {"b", report(cycles)}}), false);
  };
  const std::string differ = page(50), alike = page(100);
  EXPECT_NE(differ.find(">box: nothing to do<"), std::string::npos);
  EXPECT_EQ(differ.find(">box idle<"), std::string::npos);
  EXPECT_NE(differ.find("Throughput: ratio to run A"), std::string::npos);
  EXPECT_EQ(alike.find(": ratio to run A"), std::string::npos) << "all ratios are 1";
}

TEST(CompareRuns, ARowThatOneRunLacksHasNoRatio) {
  Json native = report(100);
  native["engine"].erase("cycles");
  const Comparison c = compare_runs({{"a", native}, {"b", report(100)}});
  const ComparedRow* length = find(c, "throughput", "length");
  ASSERT_NE(length, nullptr);
  EXPECT_FALSE(length->values[0]);
  EXPECT_FALSE(length->ratios[1]);
}

TEST(CompareRuns, ALongListIsOneDifference) {
  Json a = report(100), b = report(100);
  a["time_series"] = std::vector<int>(500, 1);
  b["time_series"] = std::vector<int>(500, 2);
  const Comparison c = compare_runs({{"a", a}, {"b", b}});
  ASSERT_EQ(c.differences.size(), 1u);
  EXPECT_EQ(c.differences[0].name, "time_series.0");
}

TEST(CompareRuns, PatternsKeepRowsSectionsAndKeys) {
  const std::vector<ComparedRun> runs{{"a", report(100)}, {"b", report(50, "aa", 8)}};
  const Comparison box = compare_runs(runs, "BOX*id");
  EXPECT_NE(find(box, "cycles of the test units", "box idle"), nullptr);
  EXPECT_EQ(find(box, "cycles of the test units", "box busy"), nullptr);
  EXPECT_TRUE(box.configuration.empty());
  EXPECT_EQ(compare_runs(runs, "resources").configuration.size(), 1u);
  EXPECT_EQ(compare_runs(runs, "bytes").sections.size(), 1u) << "a section's name keeps its rows";
}

}  // namespace
}  // namespace carousel::report
