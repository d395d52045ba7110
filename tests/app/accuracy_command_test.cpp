#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace carousel {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

// Instances, so that transforms are compared as well.
constexpr const char* kConfig =
    "scene: {builtin: instances, instances: 20}\nimage: {width: 24, height: 24, samples: 1, max_depth: 3}\n"
    "topology: {resources: 2}\nrays: {slots_per_resource: 64}\n";

const Json& level(const Json& report, const std::string& triangle, const std::string& box, const std::string& transform) {
  for (const Json& row : report.at("levels"))
    if (row.at("triangle") == triangle && row.at("box") == box && row.at("transform") == transform) return row;
  throw std::runtime_error("no row " + triangle + " " + box + " " + transform);
}

std::uint64_t wrong(const Json& errors) {
  return errors.at("missed").get<std::uint64_t>() + errors.at("extra").get<std::uint64_t>() + errors.at("other").get<std::uint64_t>();
}

class AccuracyCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    program_ = new Program;
    program_->write("a.yaml", kConfig);
    outcome_ = new Outcome(program_->run({"accuracy", "a.yaml", "--rays", "2000", "--hard-rays", "4000", "--repetitions", "2"}));
    if (outcome_->status == 0) report_ = new Json(Json::parse(program_->read("out/a/accuracy.json")));
  }
  static void TearDownTestSuite() {
    delete program_, program_ = nullptr;
    delete outcome_, outcome_ = nullptr;
    delete report_, report_ = nullptr;
  }
  void SetUp() override { ASSERT_NE(report_, nullptr) << outcome_->err; }

  static Program* program_;
  static Outcome* outcome_;
  static Json* report_;
};
Program* AccuracyCommand::program_ = nullptr;
Outcome* AccuracyCommand::outcome_ = nullptr;
Json* AccuracyCommand::report_ = nullptr;

TEST_F(AccuracyCommand, FindsTheLeaksOfTheFastLevelAndNoneOfTheWatertightOnes) {
  EXPECT_GT(level(*report_, "fast", "plain", "two_step").at("leaks"), 0);
  for (const auto& [triangle, box] : {std::pair{"watertight", "conservative"}, {"double", "double"}, {"exact", "double"}}) {
    const Json& row = level(*report_, triangle, box, "two_step");
    EXPECT_EQ(row.at("leaks"), 0) << triangle;
    EXPECT_EQ(row.at("hard").at("edges").at("missed"), 0) << triangle;
  }
}

TEST_F(AccuracyCommand, ExactTestsAgreeWithTheReferenceWhereNoTransformRounds) {
  const Json& row = level(*report_, "exact", "double", "two_step");
  for (const char* name : {"edges", "slivers"}) EXPECT_EQ(wrong(row.at("hard").at(name)), 0u) << name;
  EXPECT_GT(wrong(level(*report_, "fast", "plain", "two_step").at("hard").at("slivers")), 0u);
}

TEST_F(AccuracyCommand, OneInverseMatrixLosesFarMeshes) {
  const auto far = [&](const char* transform) {
    return level(*report_, "watertight", "conservative", transform).at("hard").at("far mesh");
  };
  EXPECT_GT(far("inverse_matrix").at("missed").get<int>(), 10 * far("two_step").at("missed").get<int>());
}

TEST_F(AccuracyCommand, ABoundedSpawnOffsetNeverHitsItsOwnTriangle) {
  for (const Json& row : report_->at("spawn")) {
    EXPECT_GT(row.at("bounces"), 100);
    if (row.at("spawn") == "bound") EXPECT_EQ(row.at("self_hits").get<int>() + row.at("far_self_hits").get<int>(), 0);
    if (row.at("spawn") == "epsilon") EXPECT_GT(row.at("far_self_hits"), 0);
  }
}

TEST_F(AccuracyCommand, TimesModelledCyclesAndPicturesAreThere) {
  for (const Json& row : report_->at("levels")) {
    EXPECT_GT(row.at("ns_per_ray").at("least"), 0);
    EXPECT_LE(row.at("ns_per_ray").at("least"), row.at("ns_per_ray").at("most"));
    EXPECT_GT(row.at("modelled_cycles_per_ray"), 0);
    EXPECT_EQ(row.at("picture").at("pixels"), 24 * 24);
  }
  // The machine waits for its shaders; its testers work longer all the same.
  EXPECT_GT(level(*report_, "double", "double", "two_step").at("modelled_tester_cycles_per_ray").get<double>(),
            2 * level(*report_, "watertight", "conservative", "two_step").at("modelled_tester_cycles_per_ray").get<double>());
  EXPECT_GE(report_->at("sampling").at("rows").size(), 6u);
  EXPECT_NEAR(report_->at("sampling").at("slope").get<double>(), -0.5, 0.2);
}

TEST_F(AccuracyCommand, PrintsATableWithAVerdictAndWritesAPicture) {
  EXPECT_THAT(outcome_->out, HasSubstr("watertight"));
  EXPECT_THAT(outcome_->out, HasSubstr("cheapest safe level"));
  EXPECT_THAT(outcome_->out, HasSubstr("Monte Carlo: -0.50"));
  EXPECT_THAT(program_->read("out/a/accuracy.svg"), HasSubstr("</svg>"));
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
