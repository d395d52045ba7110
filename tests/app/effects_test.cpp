#include "app/effects.h"

#include <gtest/gtest.h>

namespace carousel::app {
namespace {

bool is_on(const scene::Scene& scene, const Config& config, const std::string& name) {
  for (const report::Effect& effect : effects_of(scene, config)) {
    EXPECT_FALSE(effect.why.empty());
    if (effect.name == name) return effect.on;
  }
  ADD_FAILURE() << "no effect " << name;
  return false;
}

TEST(Effects, AreOnWhereTheSceneCallsForThem) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].metallic = 0;
  Config config;
  for (const char* name : {"shadow", "sky", "emission", "metallic", "texture", "normal_map", "alpha"})
    EXPECT_FALSE(is_on(scene, config, name)) << name;
  EXPECT_TRUE(is_on(scene, config, "bounce"));

  scene.lights.resize(1);
  scene.textures.resize(1);
  scene.sky.radiance = {0, 0, 1};
  scene.materials[0].metallic = 0.5f;
  scene.materials[0].normal_texture.emplace();
  config.image.max_depth = 1;
  for (const char* name : {"shadow", "sky", "metallic", "texture", "normal_map"})
    EXPECT_TRUE(is_on(scene, config, name)) << name;
  EXPECT_FALSE(is_on(scene, config, "bounce"));
}

TEST(Effects, GlowingSurfacesCallForShadowRays) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emissive = {1, 1, 1};
  EXPECT_TRUE(is_on(scene, Config{}, "shadow"));
  EXPECT_TRUE(is_on(scene, Config{}, "emission"));
}

}  // namespace
}  // namespace carousel::app
