#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/run/memory_need.h"
#include "core/config/load.h"
#include "core/config/write.h"
#include "tests/app/support/program.h"

namespace carousel {
namespace {

using testing::HasSubstr;

TEST(CheckCommand, PrintsTheResolvedConfigTheMemoryAndTheVerdict) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nimage: {width: 40}\n");
  const Outcome outcome = program.run({"check", "a.yaml", "--set", "topology.link.depth=3"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("# memory: about "));
  EXPECT_THAT(outcome.out, HasSubstr("# deadlock: impossible. credits"));
  const Config resolved = load_config({outcome.out, "check's output"}).config;
  EXPECT_EQ(resolved.image.width, 40);
  EXPECT_EQ(resolved.topology.link.depth, 3);
}

TEST(CheckCommand, ATopologyThatCanDeadlockEndsWithStatus2) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\ntopology: {flow: none}\n");
  const Outcome outcome = program.run({"check", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.out, HasSubstr("# deadlock: possible."));
}

TEST(CheckCommand, WhatDoesNotFitTheMachineIsRefusedBeforeItIsLoaded) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: cornell}\ntopology: {resources: 256}\nrays:\n  slots_per_resource: 4194304\n");
  const Outcome outcome = program.run({"check", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("a.yaml:4:23: rays.slots_per_resource: expected what fits into the machine's"));
}

TEST(MemoryNeed, NamesTheKeyThatWeighsMost) {
  const LocatedConfig located =
      load_config({"scene: {builtin: terrain, triangles: 1000000}\nimage: {width: 16}\n", "m.yaml"});
  const app::MemoryNeed need = app::estimate_before_scene(located.config, false);
  EXPECT_NO_THROW(app::require_fit(need, 1ull << 40, located.positions));
  try {
    app::require_fit(need, 1000, located.positions);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("m.yaml:1:8: scene: expected what fits"));
  }
}

TEST(MemoryNeed, KeepingHitsCounts) {
  const Config config = load_config({"scene: {builtin: cornell}\n", "m.yaml"}).config;
  EXPECT_GT(app::estimate_before_scene(config, true).total(), app::estimate_before_scene(config, false).total());
}

}  // namespace
}  // namespace carousel
