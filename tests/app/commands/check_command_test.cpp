#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/run/memory_need.h"
#include "core/config/load/load.h"
#include "core/config/write.h"
#include "tests/app/support/program.h"

namespace carousel::check_command_test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

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
  EXPECT_THAT(outcome.err, HasSubstr("a.yaml: topology.flow: the links of this machine can fill up and stop"));
}

TEST(CheckCommand, CollectionsAreLargeEnoughForBundlesUnlessTheirSizeIsGiven) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nbundles: {size: 16}\n");
  const Outcome outcome = program.run({"check", "a.yaml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Config resolved = load_config({outcome.out, "check's output"}).config;
  EXPECT_GT(resolved.collections.capacity, Config{}.collections.capacity);
  for (const char* set : {"collections.capacity=65536", "collections={capacity: 65536}"}) {
    const Outcome given = program.run({"check", "a.yaml", "--set", set});
    EXPECT_EQ(given.status, 2) << set;
    EXPECT_THAT(given.err, HasSubstr("collections.capacity: expected at least"));
  }
}

TEST(CheckCommand, WhatDoesNotFitTheMachineIsRefusedBeforeItIsLoaded) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: cornell}\ntopology: {resources: 256}\nrays:\n  slots_per_resource: 4194304\n");
  const Outcome outcome = program.run({"check", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("a.yaml:4:23: rays.slots_per_resource: expected what fits into the machine's"));
}

TEST(CheckCommand, RefusesTheMachinesThatARunRefuses) {
  const Program program;
  const std::string cycle = "scene: {builtin: cornell}\nengine: {kind: cycle}\n";
  const struct {
    std::string text, message;
  } machines[] = {
      {cycle + "topology: {resources: 8, shape: multi_ring, rings: 64}\n",
       "a.yaml:3:52: topology.rings: expected at most topology.resources = 8, found 64"},
      {cycle + "memory: {l2_kib: 2, line_bytes: 128, ways: 32}\n",
       "a.yaml:3:44: memory.ways: a cache of 2 KiB has 16 lines of 128 bytes, and a set is no larger than the cache; "
       "expected at most 16, found 32"},
      {cycle + "topology: {shape: independent}\nfaults: {links: {corrupt: 0.1}}\n",
       "a.yaml:4:17: faults.links: independent resources have no links; expected no faults of links"},
      {cycle + "workload: {rays_from: nowhere.csv}\n",
       "a.yaml:3:23: workload.rays_from: expected a file of rays beside the configuration or in the working directory, "
       "found 'nowhere.csv', which is not there"},
      {cycle + "energy: {profile: n7}\narea: {budget_mm2: 0.001, fit: refuse}\n",
       "a.yaml:4:20: area.budget_mm2: expected a machine of at most 0.001 mm2, found one of "},
  };
  for (const auto& machine : machines) {
    program.write("a.yaml", machine.text);
    for (const char* command : {"check", "run"}) {
      const Outcome outcome = program.run({command, "a.yaml"});
      EXPECT_EQ(outcome.status, 2) << command << " " << machine.text;
      EXPECT_THAT(outcome.err, HasSubstr(machine.message));
    }
  }
}

TEST(CheckCommand, ReadsTheListOfRays) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nworkload: {rays_from: rays.csv}\n");
  program.write("rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,0,0,0,1,0,inf\n");
  EXPECT_THAT(program.run({"check", "a.yaml"}).out, HasSubstr("# rays: 1 of rays.csv"));
  program.write("rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,0,0,0,0,0,inf\n");
  const Outcome outcome = program.run({"check", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("rays.csv:2:16: expected a direction, found 0,0,0"));
}

// A million zeros need no bytes in a file, and put a million instances into one place.
// Others reported this kind of fault: glTF 1699, tinybvh 92.
TEST(CheckCommand, ForetellsWhatInstancesInOnePlaceCost) {
  const Program program;
  const auto scene = [&](int instances) {
    program.write("same.gltf", R"({"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_mesh_gpu_instancing"],
"nodes": [{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}],
"scenes": [{"nodes": [0]}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
{"componentType": 5126, "count": )" +
                                   std::to_string(instances) + R"(, "type": "VEC3"}]})");
  };
  program.write("a.yaml", "scene: {file: same.gltf}\nimage: {width: 8, height: 8, samples: 1}\n");
  scene(900);
  EXPECT_THAT(program.run({"check", "a.yaml"}).err, Not(HasSubstr("a ray meets")));
  scene(5000);
  const Outcome outcome = program.run({"check", "a.yaml"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("same: 5000 instances lie in each other's boxes; a ray meets about 5000 of them"));
  EXPECT_THAT(outcome.out, HasSubstr("# build: about 2.4 MiB for the structure and the work on it"));
  scene(1'000'000);
  const Outcome limited = program.run({"check", "a.yaml", "--set", "engine.memory_limit_mib=300"});
  EXPECT_EQ(limited.status, 2);
  EXPECT_THAT(limited.err, AnyOf(HasSubstr("(engine.memory_limit_mib)"), HasSubstr("scene: expected what fits")));
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

TEST(CheckCommand, PrintsWhatItKnowsAsJson) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nimage: {width: 40}\ntopology: {rings: 3}\n");
  const Outcome outcome = program.run({"check", "a.yaml", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_TRUE(json["valid"]);
  EXPECT_EQ(json["resolved"]["image"]["width"], 40);
  EXPECT_EQ(json["deadlock"]["possible"], false);
  EXPECT_GT(json["scene"]["triangles"], 10);
  std::uint64_t sum = 0;
  for (const auto& [part, bytes] : json["memory"]["parts"].items()) sum += bytes.get<std::uint64_t>();
  EXPECT_EQ(json["memory"]["total_bytes"], sum);
  ASSERT_EQ(json["ignored_keys"].size(), 1);
  EXPECT_EQ(json["ignored_keys"][0]["key"], "topology.rings");
  EXPECT_EQ(json["ignored_keys"][0]["line"], 3);
}

TEST(CheckCommand, JsonOfARefusalNamesEachPlace) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\nimage: {width: -1}\ntopology: {resuorces: 4}\n");
  const Outcome outcome = program.run({"check", "a.yaml", "--json"});
  EXPECT_EQ(outcome.status, 2);
  const Json json = Json::parse(outcome.out);
  EXPECT_FALSE(json["valid"]);
  ASSERT_EQ(json["errors"].size(), 2);
  EXPECT_EQ(json["errors"][0]["key"], "image.width");
  EXPECT_EQ(json["errors"][0]["line"], 2);
  EXPECT_EQ(json["errors"][1]["key"], "topology.resuorces");
  program.write("b.yaml", "scene: {builtin: cornell}\ntopology: {flow: none}\n");
  const Outcome deadlock = program.run({"check", "b.yaml", "--json"});
  EXPECT_EQ(deadlock.status, 2);
  const Json stuck = Json::parse(deadlock.out);
  EXPECT_EQ(stuck["deadlock"]["possible"], true);
  EXPECT_FALSE(stuck["valid"]);
  ASSERT_EQ(stuck["errors"].size(), 1) << "what is invalid has an error";
  EXPECT_EQ(stuck["errors"][0]["key"], "topology.flow");
}

TEST(CheckCommand, StrictTakesIgnoredKeysAndWarningsOfTheImportForErrors) {
  const Program program;
  program.write("a.yaml", "scene: {builtin: cornell}\ntopology: {rings: 3}\n");
  EXPECT_EQ(program.run({"check", "a.yaml"}).status, 0);
  EXPECT_EQ(program.run({"check", "a.yaml", "--strict"}).status, 2);
  // A mesh without a camera has no warning; an extension that is unknown has one.
  program.write("a.gltf", R"({"asset": {"version": "2.0"}, "extensionsUsed": ["NOBODY_knows"], "scene": 0,
    "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]})");
  program.write("b.yaml", "scene: {file: a.gltf}\n");
  const Outcome lax = program.run({"check", "b.yaml", "--json"});
  ASSERT_EQ(lax.status, 0) << lax.err;
  const Json json = Json::parse(lax.out);
  ASSERT_GE(json["warnings"].size(), 1) << lax.out;
  EXPECT_TRUE(json["valid"]);
  const Outcome strict = program.run({"check", "b.yaml", "--json", "--strict"});
  EXPECT_EQ(strict.status, 2);
  EXPECT_FALSE(Json::parse(strict.out)["valid"]);
}

}  // namespace
}  // namespace carousel::check_command_test
