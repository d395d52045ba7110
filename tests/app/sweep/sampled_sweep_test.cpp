// Sweeps with estimates, as a user runs them. The truth is a run of each point by itself.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/sweep/sweep_program.h"

namespace carousel::sampled_sweep_test {
namespace {

using Json = nlohmann::json;

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 48, height: 32, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\nrays: {slots_per_resource: 16}\n";

TEST(SampledSweep, GivesEstimatesAndRunsTheFrontWhole) {
  const Program program;
  program.write("a.yaml", kMachine);
  const Outcome outcome = program.run({"sweep", "a.yaml", "--vary", "topology.resources=1,2,4", "--sampled=0.5",
                                       "--pareto", "cycles,max:rays_per_kilocycle", "--quiet"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json all = Json::parse(program.read("out/a/sweep.json"));
  ASSERT_EQ(all["points"].size(), 3u) << "a point that was run whole replaces its estimate";
  const Json* best = nullptr;
  for (const Json& point : all["points"]) {
    ASSERT_EQ(program
                  .run({"run", "a.yaml", "--quiet", "--force", "--out", "one", "--set",
                        "topology.resources=" + point["keys"]["topology.resources"].dump()})
                  .status,
              0);
    const double cycles = Json::parse(program.read("one/report.json"))["engine"]["cycles"];
    if (point["keys"]["sampling.fraction"] == 1)
      EXPECT_EQ(point["results"]["cycles"], cycles);
    else
      EXPECT_NEAR(point["results"]["cycles"].get<double>(), cycles, 0.3 * cycles) << "of the frame, not of its half";
    if (best == nullptr || point["results"]["cycles"] < (*best)["results"]["cycles"]) best = &point;
  }
  EXPECT_EQ((*best)["keys"]["sampling.fraction"], 1) << "the fastest machine is on the front";
}

TEST(SampledSweep, RefusesAFractionThatIsNone) {
  const Program program;
  program.write("a.yaml", kMachine);
  const Outcome outcome = program.run({"sweep", "a.yaml", "--vary", "topology.resources=1,2", "--sampled=2"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("expected a number above 0 and below 1"));
}

}  // namespace
}  // namespace carousel::sampled_sweep_test
