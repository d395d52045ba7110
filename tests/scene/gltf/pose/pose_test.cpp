// Skins, morph targets and animations at a moment. Positions are worked out by hand.
#include <cmath>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "tests/scene/gltf/pose/moving_models.h"

namespace carousel::scene::pose_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void expect_near(const std::vector<Vec3>& found, const std::vector<Vec3>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_LT(glm::length(found[i] - expected[i]), 1e-6f)
        << i << ": " << found[i].x << ' ' << found[i].y << ' ' << found[i].z;
}

TEST(Pose, WithoutAMomentTheFileStandsInItsBasePose) {
  const Scene arm = two_bone_arm().load(), square = morphed_square().load();
  EXPECT_EQ(arm.instances[0].world_from_model.translation, Vec3(100, 0, 0));
  EXPECT_EQ(arm.meshes[0].positions[4], Vec3(-0.2f, 2, 0));
  EXPECT_EQ(square.meshes[0].positions[2], Vec3(1, 1, 0));
}

TEST(Pose, TwoBonesBendTheArm) {
  const Scene scene = load_at(two_bone_arm(), 1);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].world_from_model.translation, Vec3(0));
  EXPECT_EQ(scene.instances[0].world_from_model.linear, Mat3(1.0f));
  // About (0, 1) by 90 degrees: (x, y) goes to (1 - y, 1 + x). The elbow is halfway between the two bones' opinions.
  expect_near(scene.meshes[0].positions,
              {{-0.2f, 0, 0}, {0.2f, 0, 0}, {-0.1f, 0.9f, 0}, {0.1f, 1.1f, 0}, {-1, 0.8f, 0}, {-1, 1.2f, 0}});
  EXPECT_LT(glm::length(scene.meshes[0].normals[4] - Vec3(-1, 0, 0)), 1e-6f) << "y turns to -x";
  EXPECT_LT(glm::length(scene.meshes[0].normals[5] - Vec3(0, 1, 0)), 1e-6f) << "x turns to y";
  EXPECT_LT(glm::length(scene.meshes[0].normals[0] - Vec3(0, 0, 1)), 1e-6f);
}

TEST(Pose, TurnsOnTheWayAreEven) {
  const double angle = 0.25 * std::acos(-1.0) / 2;
  const Vec3 tip = load_at(two_bone_arm(), 0.25f).meshes[0].positions[5];  // (0.2, 1) from the elbow
  EXPECT_NEAR(tip.x, 0.2 * std::cos(angle) - std::sin(angle), 1e-6);
  EXPECT_NEAR(tip.y, 1 + 0.2 * std::sin(angle) + std::cos(angle), 1e-6);
}

TEST(Pose, TimesOutsideAnAnimationAreItsEnds) {
  EXPECT_EQ(load_at(two_bone_arm(), 500).meshes[0].positions, load_at(two_bone_arm(), 1).meshes[0].positions);
  GltfBuilder late = two_bone_arm();
  late.json["animations"] = GltfBuilder::Json::array();
  animate(late, 2, "translation", {3, 4}, {0, 5, 0, 0, 9, 0}, "VEC3", 3);
  EXPECT_FLOAT_EQ(load_at(late, 0).meshes[0].positions[4].y, 6);
}

TEST(Pose, JointsMoveWithAllNodesAboveThem) {
  GltfBuilder b = two_bone_arm();
  b.json["nodes"][1]["scale"] = {2, 2, 2};
  b.json["nodes"][1]["translation"] = {0, 0, 7};
  expect_near(load_at(b, 0).meshes[0].positions,
              {{-0.4f, 0, 7}, {0.4f, 0, 7}, {-0.4f, 2, 7}, {0.4f, 2, 7}, {-0.4f, 4, 7}, {0.4f, 4, 7}});
}

TEST(Pose, WithoutInverseMatricesJointsAreBoundAtTheOrigin) {
  GltfBuilder b = two_bone_arm();
  b.json["skins"][0].erase("inverseBindMatrices");
  EXPECT_EQ(load_at(b, 0).meshes[0].positions[5], Vec3(0.2f, 3, 0));
}

TEST(Pose, TheFileWithASkinAloneNeedsNoAnimation) {
  GltfBuilder b = two_bone_arm();
  b.json.erase("animations");
  b.json["nodes"][2]["translation"] = {0, 4, 0};
  EXPECT_EQ(load_at(b, 0).meshes[0].positions[5], Vec3(0.2f, 5, 0));
}

TEST(Pose, EightJointsCountAndWeightsAreSharesOfTheirSum) {
  GltfBuilder b = two_bone_arm();
  auto& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  // Both sets in unsigned bytes: 51 of 102 to the upper arm, 51 to the forearm, for all vertices.
  std::vector<std::uint8_t> first, second, weights;
  for (int v = 0; v < 6; ++v) {
    first.insert(first.end(), {0, 0, 0, 0});
    second.insert(second.end(), {0, 0, 0, 1});
    weights.insert(weights.end(), {51, 0, 0, 0});
  }
  std::vector<std::uint8_t> others;
  for (int v = 0; v < 6; ++v) others.insert(others.end(), {0, 0, 0, 51});
  attributes["JOINTS_0"] = b.accessor(b.view(first), 5121, 6, "VEC4");
  attributes["JOINTS_1"] = b.accessor(b.view(second), 5121, 6, "VEC4");
  attributes["WEIGHTS_0"] = b.accessor(b.view(weights), 5121, 6, "VEC4", true);
  attributes["WEIGHTS_1"] = b.accessor(b.view(others), 5121, 6, "VEC4", true);
  const Vec3 tip = load_at(b, 1).meshes[0].positions[5];
  EXPECT_LT(glm::length(tip - 0.5f * (Vec3(0.2f, 2, 0) + Vec3(-1, 1.2f, 0))), 1e-6f);
}

TEST(Pose, MorphTargetsMoveTheirVertices) {
  const Scene scene = load_at(morphed_square(), 0.5f);  // a weight of 0.25
  expect_near(scene.meshes[0].positions, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0}});
}

TEST(Pose, WeightsComeFromAnimationNodeOrMesh) {
  GltfBuilder b = morphed_square();
  b.json["meshes"][0]["weights"] = {0, 1};
  EXPECT_EQ(load_at(b, 0).meshes[0].positions[0], Vec3(0, 0, 0)) << "the animation's";
  b.json.erase("animations");
  EXPECT_EQ(load_at(b, 0).meshes[0].positions[0], Vec3(3, 0, 0)) << "the mesh's";
  b.json["nodes"][0]["weights"] = {0, 2};
  EXPECT_EQ(load_at(b, 0).meshes[0].positions[0], Vec3(6, 0, 0)) << "the node's";
}

TEST(Pose, NodesWithEqualWeightsShareAMeshAndKeepTheirPlaces) {
  GltfBuilder b = morphed_square();
  b.json.erase("animations");
  b.json["nodes"][0]["weights"] = {1, 0};
  b.node({{"mesh", 0}, {"weights", {1, 0}}, {"translation", {0, 5, 0}}});
  b.node({{"mesh", 0}});
  const Scene scene = load_at(b, 0);
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances[0].mesh.value, scene.instances[1].mesh.value);
  EXPECT_EQ(scene.meshes[scene.instances[1].mesh.value].positions[2], Vec3(1, 1, 2));
  EXPECT_EQ(scene.instances[1].world_from_model.translation, Vec3(0, 5, 0));
  EXPECT_EQ(scene.meshes[scene.instances[2].mesh.value].positions[2], Vec3(1, 1, 0));
}

TEST(Pose, MorphedNormalsFollow) {
  GltfBuilder b = morphed_square();
  auto& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  primitive["targets"][0]["NORMAL"] = b.floats({0, 0, 0, 3, 0, 0, 0, 0, -2, 0, 0, 0}, "VEC3", 3);
  const std::vector<Vec3> normals = load_at(b, 2).meshes[0].normals;
  EXPECT_LT(glm::length(normals[1] - glm::normalize(Vec3(3, 0, 1))), 1e-6f);
  EXPECT_EQ(normals[2], Vec3(0, 0, -1));
}

TEST(Pose, ASkinMovesWhatMorphTargetsHaveMoved) {
  GltfBuilder b = two_bone_arm();
  b.json["meshes"][0]["primitives"][0]["targets"] = GltfBuilder::Json::array(
      {{{"POSITION", b.floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0}, "VEC3", 3)}}});
  b.json["meshes"][0]["weights"] = GltfBuilder::Json::array({1});
  EXPECT_LT(glm::length(load_at(b, 1).meshes[0].positions[5] - Vec3(-2, 1.2f, 0)), 1e-6f);
}

TEST(Pose, NormalisedIntegersAreKeysToo) {
  GltfBuilder b = two_bone_arm();
  auto& sampler = b.json["animations"][0]["samplers"][0];
  sampler["output"] =
      b.accessor(b.view(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}), 5122, 2, "VEC4", true);
  expect_near({load_at(b, 1).meshes[0].positions[5]}, {{-0.2f, 0, 0}});  // half a turn about the elbow
}

TEST(Pose, CamerasAndOrdinaryMeshesMoveToo) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  b.node({{"camera", 0}});
  animate(b, 0, "scale", {0, 1}, {1, 1, 1, 3, 1, 1}, "VEC3", 3);
  animate(b, 1, "translation", {0, 1}, {0, 0, 0, 0, 0, 8}, "VEC3", 3, "STEP");
  const Scene scene = load_at(b, 1);
  EXPECT_EQ(scene.instances[0].world_from_model.linear[0], Vec3(3, 0, 0));
  EXPECT_EQ(scene.cameras[0].position, Vec3(0, 0, 8));
  EXPECT_EQ(load_at(b, 0.9f).cameras[0].position, Vec3(0, 0, 0));
}

/// A file with two animations of one node, "walk" and "run", and a third of another node.
GltfBuilder three_animations() {
  GltfBuilder b = GltfBuilder::square();
  b.node({{"mesh", 0}, {"name", "other"}});
  animate(b, 0, "translation", {0}, {1, 0, 0}, "VEC3", 3, "LINEAR", "walk");
  animate(b, 0, "translation", {0}, {2, 0, 0}, "VEC3", 3, "LINEAR", "run");
  animate(b, 1, "translation", {0}, {0, 4, 0}, "VEC3", 3, "LINEAR", "wave");
  return b;
}

std::pair<float, float> places(const Scene& scene) {
  return {scene.instances[0].world_from_model.translation.x, scene.instances[1].world_from_model.translation.y};
}

TEST(Pose, AMomentAlonePlaysAllThatMoveDifferentNodes) {
  std::vector<std::string> warnings;
  const Scene scene = load_at(three_animations(), 0, {}, [&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(places(scene), std::pair(1.0f, 4.0f));
  EXPECT_THAT(warnings,
              ElementsAre("test.gltf: /animations/1: animation 1 \"run\" is not played, since it moves node 0 "
                          "as animation 0 \"walk\" does; scene.animation plays it alone"));
}

TEST(Pose, AnAnimationIsChosenByNameOrIndex) {
  std::vector<std::string> warnings;
  const WarningSink warn = [&](const std::string& w) { warnings.push_back(w); };
  EXPECT_EQ(places(load_at(three_animations(), 0, "run", warn)), std::pair(2.0f, 0.0f));
  EXPECT_EQ(places(load_at(three_animations(), 0, "2", warn)), std::pair(0.0f, 4.0f));
  EXPECT_THAT(warnings, IsEmpty());
  try {
    load_at(three_animations(), 0, "wlak");
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_STREQ(e.what(),
                 "scene.animation.name: no animation of test.gltf is called 'wlak'; expected one of 0 to 2, walk, run, "
                 "wave; did you mean walk?");
  }
  EXPECT_THROW(load_at(three_animations(), 0, "3"), ConfigError);
  EXPECT_THROW(load_at(GltfBuilder::square(), 0, "0"), ConfigError);
}

TEST(Pose, MotionIsListedWithAndWithoutAPose) {
  for (const Scene& scene : {two_bone_arm().load(), load_at(two_bone_arm(), 0.5f)}) {
    ASSERT_EQ(scene.motion.clips.size(), 1u);
    EXPECT_EQ(scene.motion.clips[0].name, "bend");
    EXPECT_EQ(scene.motion.clips[0].seconds, 1);
    EXPECT_EQ(scene.motion.clips[0].channels, 1u);
    EXPECT_EQ(scene.motion.skins, 1u);
  }
  EXPECT_EQ(morphed_square().load().motion.morph_targets, 2u);
  EXPECT_FALSE(GltfBuilder::square().load().motion.any());
}

TEST(Pose, ChannelsOfTheExtensionForPointersAreIgnoredByName) {
  GltfBuilder b = two_bone_arm();
  b.json["animations"][0]["channels"][0]["target"] = {
      {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/2/rotation"}}}}}};
  std::vector<std::string> warnings;
  const Scene scene = load_at(b, 1, {}, [&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(scene.meshes[0].positions[5], Vec3(0.2f, 2, 0));
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("/animations/0: 1 channels of KHR_animation_pointer, which is not read, "
                                              "are ignored")));
  b.json["extensionsRequired"] = GltfBuilder::Json::array({"KHR_animation_pointer"});
  expect_scene_error([&] { load_at(b, 1); }, "/extensionsRequired/0", "KHR_animation_pointer");
}

TEST(Pose, NamedNodesHoldTheInstancesBelowThem) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = GltfBuilder::Json::array();
  const int leaf = b.push("nodes", {{"mesh", 0}, {"name", "leaf"}});
  const int bare = b.push("nodes", {{"mesh", 0}});
  b.push("nodes", {{"name", "empty"}});
  b.node({{"name", "tree"}, {"children", {leaf, bare, 3}}});
  b.node({{"mesh", 0}, {"name", "alone"}});
  std::vector<std::string> found;
  for (const NamedNode& node : b.load().nodes)
    found.push_back(node.name + " " + std::to_string(node.first_instance) + " " + std::to_string(node.instances));
  EXPECT_THAT(found, ElementsAre("tree 0 2", "leaf 0 1", "alone 2 1"));
}

}  // namespace
}  // namespace carousel::scene::pose_test
