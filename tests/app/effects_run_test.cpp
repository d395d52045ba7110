#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/effect.h"
#include "tests/app/program.h"

namespace carousel {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr const char* kSmall = R"(schema_version: 1
scene: {builtin: cornell}
image: {width: 16, height: 12, samples: 2}
topology: {resources: 2}
)";

Json run(const Program& program, const std::string& out, const std::vector<std::string>& sets) {
  std::vector<std::string> arguments{"run", "small.yaml", "--out", out, "--quiet"};
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  const Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Json::parse(program.read(out + "/report.json"));
}

TEST(EffectsRun, AllGivesTheSamePictureOnBothEnginesAndTheReportSaysWhatAutoSaves) {
  const Program program;
  program.write("small.yaml", kSmall);
  for (const char* engine : {"engine.kind=native", "engine.kind=cycle"}) {
    const Json least = run(program, "auto", {engine}), most = run(program, "all", {engine, "shading.effects=all"});
    EXPECT_EQ(least["digest"], most["digest"]) << engine;
    EXPECT_EQ(least["shading"]["effects_choice"], "auto");
    EXPECT_EQ(most["shading"]["effects_choice"], "all");
    EXPECT_EQ(least["shading"]["effects"].size(), kEffects);
    EXPECT_GT(least["shading"]["saved"]["path_state_bytes"], 0);
    EXPECT_EQ(most["shading"]["saved"]["path_state_bytes"], 0);
  }
}

TEST(EffectsRun, AListIsNamedBesideItsOtherPicture) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Json least = run(program, "auto", {}), list = run(program, "list", {"shading.effects=[emission, bounce_rays]"});
  EXPECT_NE(least["digest"]["image"], list["digest"]["image"]);
  EXPECT_EQ(list["shading"]["effects_choice"], "[emission, bounce_rays]");
  EXPECT_EQ(list["rays"]["by_kind"]["shadow"], 0);
}

TEST(EffectsRun, InspectSaysWhatASceneCallsFor) {
  const Program program;
  const Outcome table = program.run({"inspect", "builtin:cornell"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("shadow_rays"));
  EXPECT_THAT(table.out, HasSubstr("nothing calls for it"));
  const Json json = Json::parse(program.run({"inspect", "builtin:cornell", "--json"}).out);
  EXPECT_EQ(json["effects"].size(), kEffects);
  for (const Json& effect : json["effects"])
    EXPECT_EQ(effect["on"], effect["called_for"]) << effect["name"];
  EXPECT_EQ(program.run({"inspect", "none.glb"}).status, 2);
  EXPECT_EQ(program.run({"inspect", "builtin:cornel"}).status, 2);
}

}  // namespace
}  // namespace carousel
