#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

// Instances, so that transforms are compared as well.
constexpr const char* kConfig =
    "scene: {builtin: instances, instances: 20}\nimage: {width: 24, height: 24, samples: 1, max_depth: 3}\n"
    "topology: {resources: 2}\nrays: {slots_per_resource: 64}\n";

const Json& level(const Json& report, const std::string& triangle, const std::string& box,
                  const std::string& transform) {
  for (const Json& row : report.at("levels"))
    if (row.at("triangle") == triangle && row.at("box") == box && row.at("transform") == transform) return row;
  throw std::runtime_error("no row " + triangle + " " + box + " " + transform);
}

std::uint64_t wrong(const Json& errors) {
  return errors.at("missed").get<std::uint64_t>() + errors.at("extra").get<std::uint64_t>() +
         errors.at("other").get<std::uint64_t>();
}

void finds_the_leaks_of_the_fast_level_and_none_of_the_watertight_ones(const Json& report) {
  EXPECT_GT(level(report, "fast", "plain", "two_step").at("leaks"), 0);
  for (const auto& [triangle, box] :
       {std::pair{"watertight", "conservative"}, {"double", "double"}, {"exact", "double"}}) {
    const Json& row = level(report, triangle, box, "two_step");
    EXPECT_EQ(row.at("leaks"), 0) << triangle;
    EXPECT_EQ(row.at("hard").at("edges").at("missed"), 0) << triangle;
  }
}

void exact_tests_agree_with_the_reference_where_no_transform_rounds(const Json& report) {
  const Json& row = level(report, "exact", "double", "two_step");
  for (const char* name : {"edges", "slivers"}) EXPECT_EQ(wrong(row.at("hard").at(name)), 0u) << name;
  EXPECT_GT(wrong(level(report, "fast", "plain", "two_step").at("hard").at("slivers")), 0u);
}

void one_inverse_matrix_loses_far_meshes(const Json& report) {
  const auto far = [&](const char* transform) {
    return level(report, "watertight", "conservative", transform).at("hard").at("far mesh");
  };
  EXPECT_GT(far("inverse_matrix").at("missed").get<int>(), 10 * far("two_step").at("missed").get<int>());
}

void a_bounded_spawn_offset_never_hits_its_own_triangle(const Json& report) {
  for (const Json& row : report.at("spawn")) {
    EXPECT_GT(row.at("bounces"), 100);
    if (row.at("spawn") == "bound") EXPECT_EQ(row.at("self_hits").get<int>() + row.at("far_self_hits").get<int>(), 0);
    if (row.at("spawn") == "epsilon") EXPECT_GT(row.at("far_self_hits"), 0);
  }
}

void times_modelled_cycles_and_pictures_are_there(const Json& report) {
  for (const Json& row : report.at("levels")) {
    EXPECT_GT(row.at("ns_per_ray").at("least"), 0);
    EXPECT_LE(row.at("ns_per_ray").at("least"), row.at("ns_per_ray").at("most"));
    EXPECT_GT(row.at("modelled_cycles_per_ray"), 0);
    EXPECT_EQ(row.at("picture").at("pixels"), 24 * 24);
  }
  // The machine waits for its shaders; its testers work longer all the same.
  EXPECT_GT(
      level(report, "double", "double", "two_step").at("modelled_tester_cycles_per_ray").get<double>(),
      2 * level(report, "watertight", "conservative", "two_step").at("modelled_tester_cycles_per_ray").get<double>());
  EXPECT_GE(report.at("sampling").at("rows").size(), 6u);
  EXPECT_NEAR(report.at("sampling").at("slope").get<double>(), -0.5, 0.2);
}

// One run for all: it takes a while, and each test is a process of its own.
TEST(AccuracyCommand, MeasuresWhatEachLevelGetsWrongAndCosts) {
  const Program program;
  program.write("a.yaml", kConfig);
  const Outcome outcome =
      program.run({"accuracy", "a.yaml", "--rays", "2000", "--hard-rays", "4000", "--repetitions", "2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = Json::parse(program.read("out/a/accuracy.json"));
  finds_the_leaks_of_the_fast_level_and_none_of_the_watertight_ones(report);
  exact_tests_agree_with_the_reference_where_no_transform_rounds(report);
  one_inverse_matrix_loses_far_meshes(report);
  a_bounded_spawn_offset_never_hits_its_own_triangle(report);
  times_modelled_cycles_and_pictures_are_there(report);
  EXPECT_THAT(outcome.out, HasSubstr("watertight"));
  EXPECT_THAT(outcome.out, HasSubstr("cheapest safe level"));
  EXPECT_THAT(outcome.out, HasSubstr("Monte Carlo: -0.50"));
  EXPECT_THAT(program.read("out/a/accuracy.svg"), HasSubstr("</svg>"));
}

TEST(AccuracyCommandErrors, TrafficHasNoPictures) {
  const Program program;
  program.write("t.yaml", "engine: {kind: cycle}\nworkload: {traffic: {pattern: uniform, rate: 0.1, packets: 10}}\n");
  const Outcome outcome = program.run({"accuracy", "t.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("workload"));
}

}  // namespace
}  // namespace carousel
