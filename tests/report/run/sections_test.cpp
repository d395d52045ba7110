// The sections that follow from a list: every counter and every kind of test unit stands in report.json under its name.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "report/run/report_json.h"

namespace carousel::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr RunFeatures kAllFeatures{true, true, true, true, true, true, true, true, true, true};

std::vector<std::string> keys(const Json& json) {
  std::vector<std::string> out;
  for (const auto& [key, value] : json.items()) out.push_back(key);
  return out;
}

TEST(ReportSections, EveryKindOfUnitStandsUnderItsName) {
  Report report;
  Units& units = report.resources.emplace().emplace_back().units.emplace();
  std::uint64_t busy = 10;
  for (const auto [kind, cycles] : units.kinds) cycles.busy = busy++;
  const Json without = report_json(report)["resources"][0]["units"];
  units.features = kAllFeatures;
  const Json with = report_json(report)["resources"][0]["units"];
  busy = 10;
  for (const UnitKindRow& row : kUnitKinds) {
    ASSERT_TRUE(with.contains(row.name)) << row.name;
    EXPECT_EQ(with[row.name]["busy"], busy++) << row.name;
    EXPECT_EQ(without.contains(row.name), row.shown == Shown::kAlways) << row.name;
  }
  // The order of the table of unit kinds.
  EXPECT_EQ(keys(with), (std::vector<std::string>{"box", "triangle", "plane", "bundle", "transform", "procedural",
                                                  "any_hit", "micromap", "hit_buffer", "decoder", "reciprocal",
                                                  "unit_fill", "dispatch_busy", "dispatch_idle"}));
}

TEST(ReportSections, EveryCounterOfTestsStandsUnderItsName) {
  Report report;
  Tests& tests = report.tests.emplace();
  tests.rays = 4;
  std::uint64_t count = 10;
  for (const Counter<IntersectionCounts>& row : kCounters<IntersectionCounts>) tests.counts.*row.member = count++;
  const Json without = report_json(report)["tests"];
  tests.features = kAllFeatures;
  const Json with = report_json(report)["tests"];
  count = 10;
  for (const Counter<IntersectionCounts>& row : kCounters<IntersectionCounts>) {
    EXPECT_EQ(with[row.name]["count"], count) << row.name;
    EXPECT_EQ(with[row.name]["per_ray"], static_cast<double>(count++) / 4) << row.name;
    EXPECT_EQ(without.contains(row.name), row.shown == Shown::kAlways) << row.name;
  }
  EXPECT_EQ(keys(with), (std::vector<std::string>{"box",
                                                  "plane",
                                                  "triangle",
                                                  "refined",
                                                  "bundle",
                                                  "silhouettes",
                                                  "edges",
                                                  "reciprocals",
                                                  "transforms",
                                                  "transforms_in_double",
                                                  "inversions",
                                                  "full_inversions",
                                                  "inversions_in_double",
                                                  "exact_volumes",
                                                  "extra_box_hits",
                                                  "culled",
                                                  "procedural",
                                                  "programs",
                                                  "program_cycles",
                                                  "simple_instructions",
                                                  "product_instructions",
                                                  "divide_instructions",
                                                  "branch_instructions",
                                                  "any_hit",
                                                  "micromap",
                                                  "micromap_known",
                                                  "buffer_steps",
                                                  "decoded",
                                                  "ray_reads"}));
}

TEST(ReportSections, DerivedNumbersAreOfTheCounters) {
  Report report;
  Bundles& bundles = report.tests.emplace().bundles.emplace();
  bundles.record_bytes = 8;
  bundles.by_depth.resize(2);
  bundles.by_depth[0] = {
      .all = 1, .lane_rays = 50, .split_rays = 20, .visits = 9, .visit_rays = 2, .formed = 2, .formed_rays = 7};
  bundles.by_depth[1] = {.all = 3, .split = 5};
  report.packets.emplace().counts = {
      .packets_issued = 4, .visits = 8, .bubbles = 2, .local_rays = 3, .packet_rays = 10, .seen_rays = 12};
  report.memory.emplace().caches.push_back({{.lines = 8, .hits = 6}});
  const Json json = report_json(report), found = json["tests"]["bundles"];
  EXPECT_EQ(found["formed"], 2);
  EXPECT_EQ(found["rays_mean"], 3.5);
  EXPECT_EQ(found["sum"]["depth"], 1);
  EXPECT_EQ(found["sum"]["all_hit"], 4);
  EXPECT_EQ(found["sum"]["box_tests_spared"], 30);
  EXPECT_EQ(found["sum"]["ray_reads_spared"], -7);
  EXPECT_EQ(found["ray_bytes_spared"], -56);
  EXPECT_EQ(found["by_depth"][1]["split"], 5);
  EXPECT_FALSE(found["sum"].contains("lane_rays"));
  EXPECT_EQ(json["packets"]["rays_mean"], 2.5);
  EXPECT_EQ(json["packets"]["local_fraction"], 0.25);
  EXPECT_EQ(json["packets"]["bubble_fraction"], 0.25);
  EXPECT_EQ(json["memory"]["caches"][0]["hit_fraction"], 0.75);
}

TEST(ReportSections, NoTwoKindsShareAName) {
  std::set<std::string_view> keys, names, classes;
  for (const UnitKindRow& row : kUnitKinds) {
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(classes.insert(row.work).second) << row.work;
  }
}

}  // namespace
}  // namespace carousel::report
