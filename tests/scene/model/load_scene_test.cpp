#include "scene/load_scene.h"

#include <filesystem>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"
#include "scene/model/key_light.h"
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

/// A file with a perspective and an orthographic camera, or with none.
class OwnCamera : public testing::Test {
 protected:
  OwnCamera() : folder_(std::filesystem::temp_directory_path() / ("carousel-view-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    GltfBuilder b = GltfBuilder::square();
    std::ofstream(folder_ / "bare.gltf") << b.text();
    b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    b.push("cameras",
           {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}});
    b.node({{"camera", 0}, {"translation", {0, 0, 4}}});
    b.node({{"camera", 1}});
    std::ofstream(folder_ / "cameras.gltf") << b.text();
  }
  ~OwnCamera() override { std::filesystem::remove_all(folder_); }

  Scene load(const std::string& file, std::int64_t camera, const CameraConfig& view, float aspect = 1) {
    SceneConfig config;
    config.file = file;
    config.camera = camera;
    return load_scene(config, folder_, {}, {}, {view, aspect});
  }

  std::filesystem::path folder_;
};

TEST_F(OwnCamera, TakesThePlaceOfTheFilesOwn) {
  CameraConfig view;
  view.eye = Vec3{3, 4, 0};
  view.target = Vec3{0, 0, 0};
  const Scene scene = load("cameras.gltf", 0, view);
  const Camera& c = scene.cameras[0];
  EXPECT_EQ(c.position, Vec3(3, 4, 0));
  EXPECT_NEAR(c.back.x, 0.6f, 1e-6f);
  EXPECT_NEAR(c.back.y, 0.8f, 1e-6f);
  EXPECT_NEAR(c.up.y, 0.6f, 1e-6f);
  EXPECT_EQ(c.yfov, 0.5f) << "the angle of view of the file's camera stays";
  EXPECT_EQ(c.znear, 0) << "nothing is cut off near the camera";
  EXPECT_EQ(scene.cameras.size(), 2u);
  view.up = {0, 0, 1};
  EXPECT_NEAR(load("cameras.gltf", 0, view).cameras[0].up.z, 1, 1e-6f);
  EXPECT_NEAR(load("cameras.gltf", 1, view).cameras[1].yfov, 0.69813f, 1e-5f) << "40 degrees for an orthographic one";
}

TEST_F(OwnCamera, FieldOfViewIsVerticalAndInDegrees) {
  CameraConfig view;
  view.field_of_view = 90.0f;
  const Scene scene = load("cameras.gltf", 0, view);
  EXPECT_NEAR(scene.cameras[0].yfov, 1.5707964f, 1e-6f);
  EXPECT_EQ(scene.cameras[0].position, Vec3(0, 0, 4)) << "the file's camera stands where it stood";
  try {
    load("cameras.gltf", 1, view);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(
        error.what(),
        "camera.field_of_view: the scene's camera is orthographic, and has no angle of view; expected auto, or "
        "camera.eye and camera.target beside it");
  }
}

TEST_F(OwnCamera, IsToldFromOneThatWasMadeUp) {
  EXPECT_TRUE(load("bare.gltf", 0, {}).added.camera);
  EXPECT_FALSE(load("cameras.gltf", 0, {}).added.camera);
  CameraConfig view;
  view.eye = Vec3{0, 0, 9};
  view.target = Vec3{0, 0, 0};
  EXPECT_FALSE(load("bare.gltf", 0, view).added.camera);
  EXPECT_EQ(load("bare.gltf", 0, view).cameras[0].position, Vec3(0, 0, 9));
}

TEST_F(OwnCamera, MadeUpOnesFillAWidePictureToo) {
  const Camera square = load("bare.gltf", 0, {}).cameras[0], narrow = load("bare.gltf", 0, {}, 0.25f).cameras[0];
  const Vec3 middle(0.5f, 0.5f, 0);
  EXPECT_GT(glm::length(narrow.position - middle), 2.5f * glm::length(square.position - middle));
}

TEST(LoadScene, ADarkFileGetsASun) {
  Scene scene = load_scene(builtin(BuiltinScene::kSliver), ".");
  scene.lights.clear();
  for (Material& m : scene.materials) m.emissive = Vec3(0);
  EXPECT_FALSE(has_light(scene));
  scene.materials[scene.meshes[0].triangle_materials[0].value].emissive = Vec3(1);
  EXPECT_TRUE(has_light(scene));
  // Lamps that are painted on a black texture.
  Image& image = scene.images.emplace_back();
  image.width = image.height = 10;
  image.rgba.assign(400, 0);
  for (std::size_t i = 0; i < 4; ++i) image.rgba[i] = 255;
  scene.textures.push_back({ImageId(static_cast<std::uint32_t>(scene.images.size() - 1))});
  scene.materials[scene.meshes[0].triangle_materials[0].value].emissive_texture =
      TextureUse{TextureId(static_cast<std::uint32_t>(scene.textures.size() - 1))};
  EXPECT_FALSE(has_light(scene));
  scene.images.back().rgba.assign(400, 255);
  EXPECT_TRUE(has_light(scene));
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
  } catch (const ConfigError& e) {
    EXPECT_STREQ(
        e.what(),
        "scene.file: expected a scene file, found 'nowhere.glb', which is not there; looked in 'configs' and in "
        "the working directory");
  }
}

}  // namespace
}  // namespace carousel::scene
