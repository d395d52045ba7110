// Files that move, and bounds and cameras for parts of a scene, through the program as a user runs it.
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/system/memory_budget.h"
#include "scene/images/image_decode.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/pose/moving_models.h"

namespace carousel::moving_scene_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// The column `hit` of hits.csv: 1 or 0 a ray.
std::string hits_of(const std::string& csv) {
  std::istringstream in(csv);
  std::string line, out;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::size_t at = 0;
    for (int comma = 0; comma < 10; ++comma) at = line.find(',', at) + 1;
    out += line[at];
  }
  return out;
}

class MovingScene : public testing::Test {
 protected:
  MovingScene() {
    program_.write("arm.gltf", scene::two_bone_arm().text());
    program_.write("square.gltf", scene::morphed_square().text());
    program_.write("still.gltf", scene::GltfBuilder::square().text());
    program_.write("arm.yaml", "scene: {file: arm.gltf}\nimage: {width: 8, height: 8, samples: 1}\n");
  }

  Outcome run(const std::vector<std::string>& sets) const {
    std::vector<std::string> arguments{"run", "arm.yaml", "--hits", "--out", "out", "--force"};
    add_sets(arguments, sets);
    return program_.run(arguments);
  }

  Program program_;
};

// Rays along -z at the bent forearm, the straight one, the upper arm, and where the node itself would stand.
TEST_F(MovingScene, TheBentArmIsHitWhereItIs) {
  program_.write("rays.csv",
                 "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n"
                 "0,camera,-0.8,1,5,0,0,-1,0,inf\n"
                 "1,camera,0,1.8,5,0,0,-1,0,inf\n"
                 "2,camera,0,0.2,5,0,0,-1,0,inf\n"
                 "3,camera,100,0.2,5,0,0,-1,0,inf\n");
  const std::string rays = "workload={rays_from: rays.csv}";
  const auto hits = [&](const std::vector<std::string>& more) {
    std::vector<std::string> sets{rays};
    sets.insert(sets.end(), more.begin(), more.end());
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return hits_of(program_.read("out/hits.csv"));
  };
  EXPECT_EQ(hits({}), "0001") << "in the base pose the mesh stands where its node does";
  EXPECT_EQ(hits({"scene.time=0"}), "0110");
  EXPECT_EQ(hits({"scene.time=1"}), "1010");
  EXPECT_EQ(hits({"scene.animation={name: bend, time: 1}"}), "1010");
  EXPECT_EQ(hits({"scene.animation={name: 0, time: 0}"}), "0110");
}

// The camera sees 4 by 4 units around (0, 1), so that a pixel has a side of 1/8: column c begins at x = c/8 - 2, and
// row r at y = 3 - r/8. The surface is unlit and white, and the sky black.
TEST_F(MovingScene, ThePictureShowsTheMovedMesh) {
  scene::GltfBuilder arm = scene::two_bone_arm();
  arm.push("materials", {{"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  arm.json["meshes"][0]["primitives"][0]["material"] = 0;
  program_.write("arm.gltf", arm.text());
  const auto picture = [&](const std::string& moment) {
    const Outcome outcome = run({"camera={eye: [0, 1, 1000], target: [0, 1, 0], field_of_view: 0.22918311}",
                                 "image.width=32", "image.height=32", "scene.sky={strength: 0}", moment});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string png = program_.read("out/image.png");
    MemoryBudget memory(1 << 24);
    return scene::decode_image(std::span(reinterpret_cast<const unsigned char*>(png.data()), png.size()), memory);
  };
  const auto white = [](const scene::Image& image, std::size_t column, std::size_t row) {
    return image.rgba.at(4 * (32 * row + column)) > 128;
  };
  const scene::Image straight = picture("scene.time=0"), bent = picture("scene.time=1");
  EXPECT_TRUE(white(straight, 16, 21) && white(bent, 16, 21)) << "the upper arm stays";
  EXPECT_TRUE(white(straight, 16, 9));
  EXPECT_FALSE(white(bent, 16, 9));
  EXPECT_FALSE(white(straight, 9, 15));
  EXPECT_TRUE(white(bent, 9, 15));
}

TEST_F(MovingScene, InspectListsWhatMoves) {
  const Outcome table = program_.run({"inspect", "arm.gltf"});
  EXPECT_THAT(table.out, HasSubstr("motion       1 animation, 1 skin, 0 morph targets\n"
                                   "             animation 0: \"bend\", 1 s, 1 channel\n"));
  const Json motion = Json::parse(program_.run({"inspect", "square.gltf", "--json"}).out)["motion"];
  EXPECT_EQ(motion["animations"], Json::parse(R"([{"name": "", "seconds": 2, "channels": 1}])"));
  EXPECT_EQ(motion["morph_targets"], 2);
  EXPECT_THAT(program_.run({"inspect", "still.gltf"}).out, Not(HasSubstr("motion")));
}

TEST_F(MovingScene, InspectGivesTheBoundsOfSceneAndNodes) {
  const auto listing = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> arguments{"inspect", "arm.gltf", "--json"};
    add_sets(arguments, sets);
    return Json::parse(program_.run(arguments).out);
  };
  const Json base = listing({}), bent = listing({"scene.time=1"});
  ASSERT_EQ(base["nodes"].size(), 1u) << base["nodes"];
  EXPECT_EQ(base["nodes"][0]["name"], "Arm");
  EXPECT_EQ(base["nodes"][0]["bounds"], base["bounds"]);
  EXPECT_NEAR(base["bounds"]["min"][0].get<double>(), 99.8, 1e-4);
  EXPECT_NEAR(base["bounds"]["max"][1].get<double>(), 2, 1e-6);
  EXPECT_NEAR(bent["bounds"]["min"][0].get<double>(), -1, 1e-6);
  EXPECT_NEAR(bent["bounds"]["max"][0].get<double>(), 0.2, 1e-6);
  EXPECT_NEAR(bent["bounds"]["max"][1].get<double>(), 1.2, 1e-6);
  EXPECT_THAT(program_.run({"inspect", "arm.gltf"}).out, HasSubstr("bounds       99.8 0 0 to 100.2 2 0\n"));
}

TEST_F(MovingScene, WrongMomentsAreNamed) {
  const auto refused = [&](const std::vector<std::string>& sets, const std::string& message) {
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  refused(
      {"scene.animation={name: bned, time: 0}"},
      "scene.animation.name: no animation of arm.gltf is called 'bned'; expected one of 0, bend; did you mean bend?");
  refused({"scene.animation={name: bend}", "scene.time=1"}, "scene.time: scene.animation has a time of its own");
  refused({"scene.animation={time: 1}"}, "scene.animation.name: expected the name or the index");
  refused({"scene={builtin: cornell, time: 1}"}, "scene.time: a built-in scene does not move");
  refused({"scene.time=-1"}, "scene.time: expected auto or a number from 0");
  EXPECT_THAT(run({"scene.file=still.gltf", "scene.time=1"}).err,
              HasSubstr("still.gltf: has no animations, skins or morph targets; scene.time changes nothing"));
}

// The camera that --frame proposes, pasted into a configuration, sees the node as a whole: no pixel at the edge of the
// picture shows it, and some in the middle do.
TEST_F(MovingScene, TheProposedCameraSeesTheWholeNode) {
  scene::GltfBuilder b = scene::GltfBuilder::square();
  b.json["nodes"][0].update({{"name", "far"}, {"translation", {40, 0, 0}}});
  b.node({{"mesh", 0}, {"name", "near"}, {"scale", {2, 8, 1}}, {"translation", {-30, 5, 2}}});
  program_.write("two.gltf", b.text());
  for (const std::string node : {"near", "far"}) {
    const Outcome camera =
        program_.run({"inspect", "two.gltf", "--frame", node, "--set", "image.width=32", "--set", "image.height=16"});
    ASSERT_EQ(camera.status, 0) << camera.err;
    EXPECT_THAT(camera.out, HasSubstr("\ncamera:\n  eye: ["));
    program_.write("framed.yaml",
                   "scene: {file: two.gltf}\nimage: {width: 32, height: 16, samples: 1, max_depth: 1}\n" + camera.out);
    ASSERT_EQ(program_.run({"run", "framed.yaml", "--hits", "--out", "out", "--force"}).status, 0);
    const std::string hits = hits_of(program_.read("out/hits.csv"));
    std::size_t seen = 0;
    for (const char c : hits) seen += c == '1';
    EXPECT_GT(seen, node == "near" ? 30u : 60u) << node << ": it fills the height of the picture";
    EXPECT_LT(seen, 32u * 16u / 2u);
  }
  const Outcome wrong = program_.run({"inspect", "two.gltf", "--frame", "neer"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("no node of two that shows anything is called 'neer'; did you mean near?"));
}

}  // namespace
}  // namespace carousel::moving_scene_test
