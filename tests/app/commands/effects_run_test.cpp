#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/types/effect.h"
#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/json_schema_check.h"

namespace carousel::effects_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

constexpr const char* kSmall = R"(schema_version: 1
scene: {builtin: cornell}
image: {width: 16, height: 12, samples: 2}
topology: {resources: 2}
)";

Json run(const Program& program, const std::string& out, const std::vector<std::string>& sets) {
  std::vector<std::string> arguments{"run", "small.yaml", "--out", out, "--quiet", "--force"};
  add_sets(arguments, sets);
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
    EXPECT_FALSE(most.contains("effects")) << "nothing is spared";
  }
}

TEST(EffectsRun, AProofRunsItAgainWithAllAndSaysWhatDiffers) {
  const Program program;
  program.write("small.yaml",
                "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n"
                "engine: {kind: cycle, what_if: false}\nverify: effects\nshading: {workers: 2}\n");
  const Outcome outcome = program.run({"run", "small.yaml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("all effects  hits the same   image the same"));
  const Json report = Json::parse(program.read("out/small/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  const Json& proof = report["shading"]["proof"];
  EXPECT_EQ(proof["same_hits"], true);
  EXPECT_EQ(proof["same_image"], true);
  EXPECT_GT(proof["all"]["cycles"].get<int>(), proof["auto"]["cycles"].get<int>() + 1000);
  EXPECT_EQ(proof["auto"]["cycles"], report["engine"]["cycles"]);
  EXPECT_EQ(proof["auto"]["products_per_ray"], 0);  // plain walls call for nothing that they do not have
  EXPECT_GT(proof["all"]["products_per_ray"], 0);
  // Shadow rays have room in both; the volumes that `all` leaves room for take 16 bytes a path.
  EXPECT_EQ(proof["all"]["path_state_bytes"].get<int>() - proof["auto"]["path_state_bytes"].get<int>(), 16 * 16 * 12);
  EXPECT_EQ(proof["auto"]["texture_bytes"], 0);
  EXPECT_EQ(proof["repetitions"], 7);
  EXPECT_EQ(proof["paths"], 16 * 12);
  for (const char* way : {"auto", "all"}) {
    const Json& seconds = proof[way]["seconds"];
    EXPECT_GT(seconds["least"], 0);
    EXPECT_LE(seconds["least"], seconds["median"]);
    EXPECT_LE(seconds["median"], seconds["most"]);
  }
  EXPECT_LE(proof["time_ratio"]["least"], proof["time_ratio"]["median"]);

  // The forecast from the table of products, and the run that proves it: shaders limit this machine.
  const Json& spared = report["effects"]["spared"];
  EXPECT_EQ(spared["measured"], proof["all"]["cycles"]);
  EXPECT_GE(spared["low"], report["engine"]["cycles"]);
  EXPECT_LE(spared["low"], spared["cycles_with_all"]);
  EXPECT_LE(spared["cycles_with_all"], spared["high"]);
  EXPECT_GT(spared["fraction"], 0.4);
  EXPECT_LT(std::abs(spared["error"].get<double>()), 0.1);
  EXPECT_THAT(outcome.out, HasSubstr("effects      spared "));

  EXPECT_EQ(program.run({"run", "small.yaml", "--set", "shading.effects=all"}).status, 2);
}

TEST(EffectsRun, AListIsNamedBesideItsOtherPicture) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Json least = run(program, "auto", {}), list = run(program, "list", {"shading.effects=[emission, bounce_rays]"});
  EXPECT_NE(least["digest"]["image"], list["digest"]["image"]);
  EXPECT_EQ(list["shading"]["effects_choice"], "[emission, bounce_rays]");
  EXPECT_EQ(list["rays"]["by_kind"]["shadow"], 0);
}

TEST(EffectsRun, AnImageThatNoEffectReadsNeedNotBeThere) {
  const Program program;
  scene::GltfBuilder b = scene::GltfBuilder::square();
  b.push("images", {{"uri", "nowhere.png"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  program.write("scene.gltf", b.text());
  program.write("small.yaml", "scene: {file: scene.gltf}\nimage: {width: 4, height: 4, samples: 1}\n");
  const Outcome outcome = program.run({"run", "small.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nowhere.png"));
  const Json list = run(program, "list", {"shading.effects=[sky, bounce_rays]"});
  EXPECT_EQ(list["shading"]["saved"]["images_not_decoded"], 1);
}

TEST(EffectsRun, InspectSaysWhatASceneCallsFor) {
  const Program program;
  const Outcome table = program.run({"inspect", "builtin:cornell"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("shadow_rays"));
  EXPECT_THAT(table.out, HasSubstr("nothing calls for it"));
  const Json json = Json::parse(program.run({"inspect", "builtin:cornell", "--json"}).out);
  EXPECT_EQ(json["effects"].size(), kEffects);
  for (const Json& effect : json["effects"]) {
    EXPECT_EQ(effect["on"], effect["called_for"]) << effect["name"];
    if (effect["name"] == "shadow_rays") {
      EXPECT_EQ(effect["cost"]["cycles_per_path"], 4 * 20);  // default depth and cycles
    }
  }
  EXPECT_EQ(program.run({"inspect", "none.glb"}).status, 2);
  EXPECT_EQ(program.run({"inspect", "builtin:cornel"}).status, 2);
}

}  // namespace
}  // namespace carousel::effects_run_test
