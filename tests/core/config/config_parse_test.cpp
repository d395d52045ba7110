#include <fstream>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/config/write.h"
#include "tests/core/config/config_issues.h"

namespace carousel {
namespace {

TEST(ConfigParse, GivesTheDefaultsOfTheDesignForASmallFile) {
  const Config config = parse_config("scene: {builtin: cornell}\n", "small.yaml");
  EXPECT_EQ(config.scene.builtin, BuiltinScene::kCornell);
  EXPECT_EQ(config.image.width, 256);
  EXPECT_FALSE(config.engine.threads.has_value());
  EXPECT_FALSE(config.scene.sky.has_value());
  EXPECT_EQ(config.topology.link.queue, QueueKind::kSpscRing);
  EXPECT_EQ(config.testers.units[UnitKind::kBox].units, 4);
}

TEST(ConfigParse, TakesTheLineThatTellsEditorsOfTheSchema) {
  const char* text = R"({"$schema": "schema.json", "scene": {"builtin": "cornell"}, "image": {"width": 64}})";
  EXPECT_EQ(parse_config(text, "small.json").image.width, 64);
  EXPECT_EQ(parse_config(text, "small.yaml").image.width, 64);  // YAML takes JSON
  EXPECT_EQ(texts(issues_of(R"({"$schema": 7, "scene": {"builtin": "cornell"}})", {}, "small.json")),
            (std::vector<std::string>{"small.json:1:13: $schema: expected the address of the schema, found 7"}));
  EXPECT_EQ(issues_of(R"({"scene": {"builtin": "cornell", "$schema": "schema.json"}})", {}, "small.json").size(), 1u);
}

TEST(ConfigParse, ReadsEveryFormOfTheContract) {
  const Config config = parse_config(R"(
schema_version: 1
scene:     {file: scenes/atrium.glb, camera: 2, sky: {color: [0.6, 0.7, 1], strength: 0.1}}
camera:    {aperture: 0.25, focus_distance: 3}
engine:    {kind: native, threads: 3, simd: avx2}
topology:
  resources: 4
  shape: point_to_point
  link: {queue: mutex, depth: 2}
  overrides: [{resource: 3, testers: {box: {units: 2}}}]
testers:   {box: {latency_cycles: 9}, triangle: 7, simd: {lanes: 8, map: rays}}
collections: {traversal: treelet, select: strict}
verify: reference
workload: {rays_from: rays.csv}
vary: {packets.rays: [8, 16], topology.resources: 1..64*2}
)",
                                     "contract.yaml");
  EXPECT_EQ(config.scene.file, "scenes/atrium.glb");
  ASSERT_TRUE(config.scene.sky.has_value());
  EXPECT_EQ(config.scene.sky->color, Vec3(0.6f, 0.7f, 1.0f));
  EXPECT_EQ(config.scene.sky->strength, 0.1f);
  EXPECT_EQ(config.engine.threads, 3);
  EXPECT_EQ(config.engine.simd, SimdTarget::kAvx2);
  EXPECT_EQ(config.topology.shape, TopologyShape::kPointToPoint);
  EXPECT_EQ(config.topology.visit, Visit::kOwners) << "point_to_point implies it";
  EXPECT_EQ(config.testers.units[UnitKind::kTriangle].units, 7);
  EXPECT_EQ(config.testers.simd.map, TestersConfig::Simd::Map::kRays);
  ASSERT_EQ(config.topology.overrides.size(), 1u);
  EXPECT_EQ(config.topology.overrides[0].testers.units[UnitKind::kBox].units, 2);
  EXPECT_EQ(config.topology.overrides[0].testers.units[UnitKind::kBox].latency_cycles, 9)
      << "an override starts from testers";
  EXPECT_EQ(config.topology.overrides[0].testers.units[UnitKind::kTriangle].units, 7);
  EXPECT_EQ(config.verify, Verify::kReference);
  EXPECT_EQ(config.workload.kind, WorkloadConfig::Kind::kRaysFrom);
  EXPECT_EQ(config.workload.rays_from, "rays.csv");
  EXPECT_EQ(config.vary.at("packets.rays"), (std::vector<std::string>{"8", "16"}));
  EXPECT_EQ(config.vary.at("topology.resources"), (std::vector<std::string>{"1..64*2"}));
}

TEST(ConfigParse, ReadsTheSameFromYamlAndJson) {
  const Config yaml = parse_config(
      "scene: {builtin: spheres, triangles: 500}\nimage: {width: 7}\nengine: {threads: auto}\n"
      "camera: {aperture: 1e-3}\n",
      "a.yaml");
  const Config json = parse_config(R"({"scene": {"builtin": "spheres", "triangles": 500},
    "image": {"width": 7}, "engine": {"threads": "auto"}, "camera": {"aperture": 1e-3}})",
                                   "a.json");
  EXPECT_EQ(resolved_yaml(yaml), resolved_yaml(json));
}

TEST(ConfigParse, ReadsHexadecimalNumbers) {
  EXPECT_EQ(parse_config("scene: {builtin: cornell}\nimage: {seed: 0x10}\n", "a").image.seed, 16);
}

TEST(ConfigParse, ExpandsAliases) {
  const Config config = parse_config("scene: {builtin: cornell}\ntesters: {box: &t {units: 3}, plane: *t}\n", "a.yaml");
  EXPECT_EQ(config.testers.units[UnitKind::kPlane].units, 3);
}

TEST(ConfigParse, ReportsAllErrorsOfAFileTogetherInItsOrder) {
  const auto issues = issues_of(R"(image: {width: 0, height: tall}
topolgy: {resources: 2}
packets:
  rays: 4096
  shapes: stripe
bundles: {size: 1}
)");
  EXPECT_EQ(texts(issues),
            (std::vector<std::string>{
                "test.yaml: scene: expected a scene: file, or builtin (cornell, spheres, terrain, instances, "
                "sliver, foliage, gaussians)",
                "test.yaml:1:16: image.width: expected an integer from 1 to 16384 (pixels), found 0",
                "test.yaml:1:27: image.height: expected an integer from 1 to 16384 (pixels), found 'tall'",
                "test.yaml:2:1: topolgy: unknown key; did you mean 'topology'?",
                "test.yaml:4:9: packets.rays: expected an integer from 1 to 1024 (rays), found 4096",
                "test.yaml:5:11: packets.shapes: expected one of strip, single, found 'stripe'; did you mean "
                "'strip'?",
                "test.yaml:6:17: bundles.size: expected 2 rays or more, or 0 for none; found 1",
            }));
}

TEST(ConfigParse, ManyUnknownKeysTakeNoTime) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) text += "unknown" + std::to_string(i) + ": 1\n";
  EXPECT_EQ(issues_of(text).size(), 10'001u) << "each of them, and the missing scene";
}

TEST(ConfigParse, LoadsAFileAndNamesItInErrors) {
  const std::string path = testing::TempDir() + "carousel_config_parse_test.yaml";
  std::ofstream(path) << "scene: {builtin: cornell}\n";
  EXPECT_EQ(load_config(read_config_file(path)).config.scene.builtin, BuiltinScene::kCornell);
  std::ofstream(path) << "scene: {builtin: cornel}\n";
  try {
    load_config(read_config_file(path));
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(path + ":1:18: scene.builtin:"), std::string::npos) << error.what();
  }
}

TEST(ConfigParse, RefusesFilesThatCannotBeRead) {
  EXPECT_THROW(read_config_file("/nonexistent/carousel.yaml"), ConfigError);
  EXPECT_THROW(read_config_file(testing::TempDir()), ConfigError);
  EXPECT_THROW(load_config(read_config_file("/dev/zero")), ConfigError);
}

TEST(ConfigParse, KeepsThePositionsOfValues) {
  const std::vector<std::string> sets{"rays.placement=round_robin"};
  const LocatedConfig located = load_config({"scene: {builtin: cornell}\npackets:\n  rays: 4\n", "p.yaml"}, sets);
  EXPECT_EQ(located.positions.find("packets.rays").text(), "p.yaml:3:9");
  EXPECT_EQ(located.positions.find("packets.shapes").text(), "p.yaml:3:3") << "not given: the section";
  EXPECT_EQ(located.positions.find("topology.link.depth").text(), "p.yaml");
  EXPECT_EQ(located.positions.find("rays.placement").text(), "--set rays.placement=round_robin");
}

}  // namespace
}  // namespace carousel
