#include "scene/load_scene.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

SceneConfig builtin(BuiltinScene kind) {
  SceneConfig config;
  config.builtin = kind;
  config.triangles = 500;
  return config;
}

TEST(LoadScene, FileIsFoundBesideTheConfigAndGetsTheDefaultSky) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("carousel-load-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "square.gltf") << GltfBuilder::square().text();
  SceneConfig config;
  config.file = "square.gltf";
  const Scene scene = load_scene(config, folder);
  EXPECT_EQ(scene.instanced_triangle_count(), 2u);
  EXPECT_EQ(scene.sky.radiance, Vec3(0.6f, 0.7f, 0.9f));
  EXPECT_EQ(scene.lights.size(), 1u) << "a file without light gets a sun";
  config.sky = SkyConfig{{1, 1, 1}, 0};
  EXPECT_EQ(load_scene(config, folder).sky.radiance, Vec3(0));
  EXPECT_TRUE(load_scene(config, folder).lights.empty()) << "a configured sky is left alone";
  std::filesystem::remove_all(folder);
}

TEST(LoadScene, ConfigSkyReplacesTheBuiltinOne) {
  SceneConfig config = builtin(BuiltinScene::kSpheres);
  EXPECT_GT(load_scene(config, ".").sky.radiance.z, 0.0f);
  config.sky = SkyConfig{{1, 0.5f, 0.25f}, 2};
  EXPECT_EQ(load_scene(config, ".").sky.radiance, Vec3(2, 1, 0.5f));
}

TEST(LoadScene, NeitherOrBothOfFileAndBuiltinIsRefused) {
  SceneConfig config;
  EXPECT_THROW(load_scene(config, "."), ConfigError);
  config = builtin(BuiltinScene::kCornell);
  config.file = "a.glb";
  EXPECT_THROW(load_scene(config, "."), ConfigError);
}

TEST(LoadScene, CameraBeyondTheLastIsRefusedWithTheRange) {
  SceneConfig config = builtin(BuiltinScene::kCornell);
  config.camera = 1;
  try {
    load_scene(config, ".");
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_STREQ(e.what(), "scene.camera: expected 0 to 0 (the cameras of this scene), found 1");
  }
}

TEST(LoadScene, MissingFileNamesBothPlaces) {
  SceneConfig config;
  config.file = "nowhere.glb";
  try {
    load_scene(config, "configs");
    FAIL();
  } catch (const SceneError& e) {
    EXPECT_STREQ(e.what(), "nowhere.glb: no such file; looked in 'configs' and in the working directory");
  }
}

}  // namespace
}  // namespace carousel::scene
