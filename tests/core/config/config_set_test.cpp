#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/config/config_issues.h"

namespace carousel {
namespace {

using testing::ElementsAre;

Config with(const std::string& text, const std::vector<std::string>& sets) {
  return parse_config(text, "test.yaml", sets);
}

const char* const kScene = "scene: {builtin: cornell}\n";

TEST(ConfigSet, ReplacesAndMakesWhatIsMissing) {
  const Config config = with("scene: {builtin: cornell}\nimage: {width: 9}\n",
                             {"image.width=10", "topology.link.depth=2", "scene.sky={color: [0, 0, 1]}"});
  EXPECT_EQ(config.image.width, 10);
  EXPECT_EQ(config.topology.link.depth, 2);
  EXPECT_EQ(config.scene.sky->color, Vec3(0, 0, 1));
}

TEST(ConfigSet, LaterOnesWin) {
  EXPECT_EQ(with(kScene, {"image.width=10", "image.width=11"}).image.width, 11);
}

TEST(ConfigSet, WorksOnAnEmptyFileAndOnJson) {
  EXPECT_EQ(with("", {"scene.builtin=sliver"}).scene.builtin, BuiltinScene::kSliver);
  EXPECT_EQ(with(R"({"scene": {"builtin": "cornell"}})", {"image.width=3"}).image.width, 3);
}

TEST(ConfigSet, IndexesLists) {
  const Config made = with(kScene, {"topology.overrides.0.resource=3", "topology.overrides.0.testers.box=2"});
  ASSERT_EQ(made.topology.overrides.size(), 1u);
  EXPECT_EQ(made.topology.overrides[0].resource, 3);
  EXPECT_EQ(made.topology.overrides[0].testers.units[UnitKind::kBox].units, 2);
  const Config changed = with("scene: {builtin: cornell}\ntopology: {overrides: [{resource: 1}, {resource: 2}]}\n",
                              {"topology.overrides.1.resource=5"});
  EXPECT_EQ(changed.topology.overrides[1].resource, 5);
}

TEST(ConfigSet, KeepsABareNumberOfUnits) {
  const Config config = with("scene: {builtin: cornell}\ntesters: {box: 3}\n", {"testers.box.latency_cycles=8"});
  EXPECT_EQ(config.testers.units[UnitKind::kBox].units, 3);
  EXPECT_EQ(config.testers.units[UnitKind::kBox].latency_cycles, 8);
}

TEST(ConfigSet, TurnsTheWorkloadIntoAMap) {
  EXPECT_EQ(with("scene: {builtin: cornell}\nworkload: rays\n", {"workload.rays_from=a=b.csv"}).workload.rays_from,
            "a=b.csv");
}

TEST(ConfigSet, TakesAKeyPathBelowVary) {
  EXPECT_EQ(with(kScene, {"vary.packets.rays=[1, 2]"}).vary.at("packets.rays"), (std::vector<std::string>{"1", "2"}));
}

TEST(ConfigSet, NamesItselfAsThePosition) {
  EXPECT_THAT(texts(issues_of(kScene, {"image.width=0", "image.wdth=2"})),
              ElementsAre("--set image.width=0: image.width: expected an integer from 1 to 16384 (pixels), found 0",
                          "--set image.wdth=2: image.wdth: unknown key; did you mean 'width'?"));
}

TEST(ConfigSet, RefusesWhatIsNoAssignment) {
  EXPECT_THAT(texts(issues_of(kScene, {"image.width"})), ElementsAre("--set image.width: expected key.path=value"));
  EXPECT_THAT(texts(issues_of(kScene, {"=3"})), ElementsAre("--set =3: expected key.path=value"));
  EXPECT_THAT(texts(issues_of(kScene, {"image..width=3"})),
              ElementsAre("--set image..width=3: image..width: expected key.path=value, with names between the dots"));
  EXPECT_THAT(texts(issues_of(kScene, {"image.=3"})),
              ElementsAre("--set image.=3: image.: expected key.path=value, with names between the dots"));
}

TEST(ConfigSet, RefusesAnIndexOutsideOfTheList) {
  EXPECT_THAT(texts(issues_of(kScene, {"topology.overrides.2.resource=1"})),
              ElementsAre("--set topology.overrides.2.resource=1: topology.overrides.2.resource: the list has 0 "
                          "entries; expected an index from 0 to 0, found '2'"));
}

TEST(ConfigSet, RefusesSyntaxErrorsInItsValue) {
  EXPECT_THAT(texts(issues_of(kScene, {"image={width: 3"})),
              ElementsAre("--set image={width: 3: image: expected a name as the key, found a map (or is a bracket not "
                          "closed?)"));
}

}  // namespace
}  // namespace carousel
