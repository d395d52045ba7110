// Animations and skins of files that Assimp reads, at a moment. Positions are worked out by hand.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "core/system/error.h"
#include "tests/scene/import/import_files.h"
#include "tests/scene/import/moving_files.h"

namespace carousel::scene::import_pose_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ImportPose : public ImportFiles {
 protected:
  Scene at(const std::string& name, float seconds, std::optional<std::string> animation = {}) {
    return load(name, PoseChoice{seconds, std::move(animation)});
  }
};

/// The corners of everything in the scene, in the world.
std::vector<Vec3> world_corners(const Scene& scene) {
  std::vector<Vec3> out;
  for (const Instance& instance : scene.instances)
    for (const Vec3& p : scene.meshes.at(instance.mesh.value).positions)
      out.push_back(instance.world_from_model.linear * p + instance.world_from_model.translation);
  return out;
}

/// The readers order vertices as they like.
void expect_corners(const Scene& scene, const std::vector<Vec3>& expected) {
  const std::vector<Vec3> found = world_corners(scene);
  EXPECT_EQ(found.size(), expected.size());
  for (const Vec3& e : expected)
    EXPECT_TRUE(std::ranges::any_of(found, [&](const Vec3& f) { return glm::length(f - e) < 2e-5f; }))
        << "no corner at " << e.x << ' ' << e.y << ' ' << e.z << "; the first is at " << found.at(0).x << ' '
        << found[0].y << ' ' << found[0].z;
}

TEST_F(ImportPose, ANodeOfColladaGoesAndTurns) {
  write("a.dae", moving_collada());
  expect_corners(load("a.dae"), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_THAT(warnings_, Contains(HasSubstr("the base pose is shown")));
  const float h = std::sqrt(0.5f);
  expect_corners(at("a.dae", 0.5f), {{1, 0, 0}, {1 + h, h, 0}, {1 - h, h, 0}});
  EXPECT_THAT(warnings_, Not(Contains(HasSubstr("base pose"))));
  expect_corners(at("a.dae", 1), {{2, 0, 0}, {2, 1, 0}, {1, 0, 0}});
  expect_corners(at("a.dae", 1.5f), {{3, 0, 0}, {3, 1, 0}, {2, 0, 0}});
  expect_corners(at("a.dae", 99), {{4, 0, 0}, {4, 1, 0}, {3, 0, 0}});
}

TEST_F(ImportPose, ANodeOfFbxGoes) {
  write("a.fbx", kMovingFbx);
  const Scene scene = at("a.fbx", 0.25f, "wave");
  expect_corners(scene, {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}});
  ASSERT_EQ(scene.motion.clips.size(), 1u);
  EXPECT_NEAR(scene.motion.clips[0].seconds, 1, 1e-6);
  expect_corners(at("a.fbx", 1, "0"), {{8, 0, 0}, {9, 0, 0}, {8, 1, 0}});
}

TEST_F(ImportPose, TwoBonesBendTheArmAsInGltf) {
  write("a.dae", arm_collada());
  EXPECT_EQ(load("a.dae").motion.skins, 1u);
  const Scene straight = at("a.dae", 0);
  expect_corners(straight, {{-0.2f, 0, 0}, {0.2f, 0, 0}, {-0.2f, 1, 0}, {0.2f, 1, 0}, {-0.2f, 2, 0}, {0.2f, 2, 0}});
  const Scene bent = at("a.dae", 1);
  ASSERT_EQ(bent.instances.size(), 1u);
  EXPECT_EQ(bent.instances[0].world_from_model.translation, Vec3(0)) << "the node itself has no part in it";
  expect_corners(bent, {{-0.2f, 0, 0}, {0.2f, 0, 0}, {-0.1f, 0.9f, 0}, {0.1f, 1.1f, 0}, {-1, 0.8f, 0}, {-1, 1.2f, 0}});
}

TEST_F(ImportPose, AnimationsAreNamedOrRefused) {
  write("a.fbx", kMovingFbx);
  try {
    at("a.fbx", 0, "wav");
    FAIL() << "played an animation that is not there";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.issues().at(0).key_path, "scene.animation.name");
    EXPECT_THAT(error.what(), HasSubstr("is called 'wav'; expected one of 0, wave; did you mean wave?"));
  }
}

}  // namespace
}  // namespace carousel::scene::import_pose_test
