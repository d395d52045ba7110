#include "app/build_report/effects.h"

#include <gtest/gtest.h>

namespace carousel::app {
namespace {

TEST(Effects, TheReportNamesThemAllWithTheirReasons) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.meshes.resize(1);
  scene.meshes[0].triangle_materials = {MaterialId(0)};
  scene.instances.resize(1);
  scene.materials[0].emissive = {1, 1, 1};
  scene.images.resize(1);  // no texture uses the image
  Config config;
  report::Shading shading;
  add_effects(shading, scene, config);
  ASSERT_EQ(shading.effects.size(), kEffects);
  for (const report::Effect& effect : shading.effects) {
    EXPECT_FALSE(effect.why.empty()) << effect.name;
    EXPECT_EQ(effect.on, effect.called_for) << effect.name;
    const bool expected = effect.name == "emission" || effect.name == "area_lights" || effect.name == "shadow_rays" ||
                          effect.name == "bounce_rays" || effect.name == "reflection";
    EXPECT_EQ(effect.on, expected) << effect.name;
  }
  EXPECT_EQ(shading.effects_choice, "auto");
  EXPECT_EQ(shading.saved.images_not_decoded, 1u);
  EXPECT_GT(shading.saved.path_state_bytes, 0u);
  ASSERT_EQ(shading.classes.size(), 1u);
  EXPECT_EQ(shading.classes[0].name, "plain");

  config.shading.effects = {ShadingConfig::Effects::Choice::kList, {"sky", "emission"}};
  report::Shading list;
  add_effects(list, scene, config);
  EXPECT_EQ(list.effects_choice, "[sky, emission]");
}

}  // namespace
}  // namespace carousel::app
