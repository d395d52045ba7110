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
    "engine: {kind: cycle, threads: 1, what_if: false}\nenergy: {profile: n7}\nrays: {slots_per_resource: 16}\n";

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
    const Json whole = Json::parse(program.read("one/report.json"));
    const double cycles = whole["engine"]["cycles"], nj_per_ray = whole["energy"]["nj_per_ray"];
    const double per_mm2 = whole["area"]["mrays_per_second_per_mm2"];
    double bytes = 0;
    for (const Json& row : whole["bytes"]) bytes += row["bytes"].get<double>();
    const auto off = [&](const char* key, double truth) { return point["results"][key].get<double>() / truth - 1; };
    if (point["keys"]["sampling.fraction"] == 1) {
      EXPECT_EQ(point["results"]["cycles"], cycles);
      EXPECT_EQ(point["results"]["bytes"], bytes);
      EXPECT_EQ(point["results"]["nj_per_ray"], nj_per_ray);
    } else {
      EXPECT_NEAR(off("cycles", cycles), 0, 0.3) << "of the frame, not of its half";
      EXPECT_NEAR(off("mrays_per_second_per_mm2", per_mm2), 0, 0.3);
      EXPECT_NEAR(off("bytes", bytes), 0, 0.1);
      EXPECT_NEAR(off("nj_per_ray", nj_per_ray), 0, 0.1);
    }
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
