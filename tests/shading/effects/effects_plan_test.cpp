#include "shading/effects/effects_plan.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shading/path/volume_stack.h"
#include "shading/surface/alpha_test.h"
#include "shading/tracer/path_tracer.h"
#include "shading/tracer/surface_class.h"
#include "tests/shading/effects/effect_scenes.h"
#include "tests/shading/path/brute_force_tracer.h"
#include "tests/shading/path/threaded_frame.h"

namespace carousel::shading {
namespace {

using Choice = ShadingConfig::Effects::Choice;

Config small_image(Choice choice = Choice::kAuto, std::vector<std::string> names = {}) {
  Config config;
  config.image = {24, 24, 4, 5, 3};
  config.shading.effects = {choice, std::move(names)};
  return config;
}

struct Picture {
  std::string image, hits;
  PathTracer::Counts counts;
  std::vector<float> rgb;
};

Picture picture(scene::Scene scene, const Config& config) {
  strip_effects(scene, config.shading.effects);
  const AlphaTest alpha(scene);
  PathTracer tracer(scene, config, 1000, 1);
  run_frame(tracer, BruteForceTracer(scene, &alpha), 200);
  EXPECT_EQ(tracer.counts().saturated, 0u);
  return {tracer.image_digest(), tracer.hits_digest().hex(), tracer.counts(), tracer.linear_rgb()};
}

std::vector<std::string> all_but(Effect effect) {
  std::vector<std::string> names;
  for (const std::string_view name : kEffectNames)
    if (name != effect_name(effect)) names.emplace_back(name);
  return names;
}

Config config_for(Effect effect) {
  Config config = small_image();
  if (effect == Effect::kDepthOfField) {
    config.camera.aperture = 0.8f;
    config.camera.focus_distance = 3;
  }
  return config;
}

TEST(EffectsPlan, EverythingGivesTheSamePictureAsWhatTheSceneCallsFor) {
  std::vector<scene::Scene> scenes{mixed_scene(), scene_of_everything()};
  for (std::size_t i = 0; i < kEffects; ++i) scenes.push_back(scene_that_calls_for(static_cast<Effect>(i)));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Picture least = picture(scenes[i], small_image()), most = picture(scenes[i], small_image(Choice::kAll));
    EXPECT_EQ(least.image, most.image) << i;
    EXPECT_EQ(least.hits, most.hits) << i;
  }
}

TEST(EffectsPlan, AListOfAllThatIsCalledForIsTheSameAsNone) {
  const scene::Scene scene = scene_of_everything();
  std::vector<std::string> names(kEffectNames.begin(), kEffectNames.end());
  EXPECT_EQ(picture(scene, small_image(Choice::kList, names)).image, picture(scene, small_image()).image);
}

TEST(EffectsPlan, EachEffectIsCalledForByItsSceneAndChangesThePictureWhenItIsLeftOut) {
  for (std::size_t i = 0; i < kEffects; ++i) {
    const auto effect = static_cast<Effect>(i);
    const scene::Scene scene = scene_that_calls_for(effect);
    Config config = config_for(effect);
    const EffectsPlan plan = plan_effects(scene, config);
    EXPECT_TRUE(plan.of(effect).called_for) << effect_name(effect) << ": " << plan.of(effect).why;
    EXPECT_TRUE(plan.on(effect)) << effect_name(effect);
    const Picture with = picture(scene, config);
    config.shading.effects = {Choice::kList, all_but(effect)};
    EXPECT_FALSE(plan_effects(scene, config).on(effect)) << effect_name(effect);
    EXPECT_NE(picture(scene, config).image, with.image) << effect_name(effect);
  }
}

TEST(EffectsPlan, NothingIsCalledForByAPlainWall) {
  scene::Scene scene = empty_scene();
  add_quad(scene, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}, add_material(scene, matte({1, 1, 1})));
  scene::Material unused;
  unused.transmission.weight = 1;
  unused.clearcoat.weight = 1;
  unused.emissive = Vec3{1};
  add_material(scene, unused);  // on no triangle
  const EffectsPlan plan = plan_effects(scene, small_image());
  for (std::size_t i = 0; i < kEffects; ++i) {
    const bool expected = static_cast<Effect>(i) == Effect::kReflection;
    EXPECT_EQ(plan.effects[i].on, expected) << kEffectNames[i];
    EXPECT_FALSE(plan.effects[i].why.empty());
  }
  // Without light there are camera rays only, and path states have no room for other rays.
  const Picture least = picture(scene, small_image()), most = picture(scene, small_image(Choice::kAll));
  EXPECT_EQ(least.counts.emitted[1] + least.counts.emitted[2], 0u);
  EXPECT_GT(most.counts.emitted[1], 0u);
  EXPECT_EQ(least.image, most.image);
  EXPECT_LT(plan.path_state_bytes(), plan_effects(scene, small_image(Choice::kAll)).path_state_bytes());
}

TEST(EffectsPlan, EachMaterialHasTheLeastCodeThatShadesIt) {
  const scene::Scene scene = scene_of_everything();
  const auto of = surface_classes(scene, plan_effects(scene, small_image()));
  EXPECT_EQ(of[0], SurfaceClass::kPlain);  // the floor beside the glass
  EXPECT_EQ(of[2], SurfaceClass::kLayeredTransmissive);
  EXPECT_EQ(of[4], SurfaceClass::kUnlit);
  for (const SurfaceClass c : surface_classes(scene, plan_effects(scene, small_image(Choice::kAll))))
    EXPECT_EQ(c, SurfaceClass::kAnything);
}

TEST(EffectsPlan, ATextureMakesGlassOfWhatIsMetalByDefault) {
  scene::Scene scene = scene_that_calls_for(Effect::kVolume);
  scene.images[0].rgba = {0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255};  // B: no metal
  scene.materials[2].metallic = 1;
  EXPECT_FALSE(plan_effects(scene, small_image()).on(Effect::kTransmission));
  scene.materials[2].metallic_roughness_texture.emplace();
  const EffectsPlan plan = plan_effects(scene, small_image());
  for (const Effect effect : {Effect::kTransmission, Effect::kRefraction, Effect::kVolume})
    EXPECT_TRUE(plan.on(effect));
  EXPECT_EQ(surface_classes(scene, plan)[2], SurfaceClass::kTransmissive);
  const Picture glass = picture(scene, small_image());
  EXPECT_EQ(glass.image, picture(scene, small_image(Choice::kAll)).image);
  scene.materials[2].metallic = 0;
  scene.materials[2].metallic_roughness_texture.reset();
  const Picture plain = picture(scene, small_image());
  for (std::size_t i = 0; i < glass.rgb.size(); ++i)
    EXPECT_NEAR(glass.rgb[i], plain.rgb[i], 1e-3f + 0.01f * plain.rgb[i]);
}

TEST(EffectsPlan, ImagesAreReadOnlyByEffectsThatAreOn) {
  scene::Scene scene = scene_that_calls_for(Effect::kClearcoat);
  scene.materials[2].transmission.texture.emplace();  // the transmission has weight 0
  const std::vector<bool> yes{true}, no{false};
  EXPECT_EQ(images_read(scene, {}), no);
  EXPECT_EQ(images_read(scene, {Choice::kAll, {}}), yes);
  scene = scene_that_calls_for(Effect::kBaseColorTexture);
  EXPECT_EQ(images_read(scene, {}), yes);
  EXPECT_EQ(images_read(scene, {Choice::kList, {"base_color_texture"}}), yes);
  EXPECT_EQ(images_read(scene, {Choice::kList, {"normal_map", "shadow_rays"}}), no);
  scene.instances.clear();
  EXPECT_EQ(images_read(scene, {}), no);
}

TEST(EffectsPlan, CyclesAreThoseOfTheConfiguration) {
  Config config = small_image();
  config.image.max_depth = 3;
  config.shading.cycles_per_shade = 20;
  config.shading.cycles_per_lookup = 7;
  config.shading.products_per_cycle = 10;
  config.shading.cycles_per_any_hit = 11;
  config.testers.units[UnitKind::kAnyHit].interval_cycles = 2;
  const EffectsPlan plan = plan_effects(scene_of_everything(), config);
  EXPECT_EQ(plan.of(Effect::kClearcoat).cost.cycles_per_hit, 2u * 7 + 22);  // 2 lookups, 214 products
  EXPECT_EQ(cost_of(rule_of(Effect::kIor), config, 3).cycles_per_hit, 1u);  // 10 products
  EXPECT_EQ(plan.of(Effect::kAlphaBlend).cost.cycles_per_hit, 2u);
  EXPECT_EQ(plan.of(Effect::kShadowRays).cost.cycles_per_path, 3u * 20);
  EXPECT_EQ(plan.of(Effect::kBounceRays).cost.cycles_per_path, 2u * 20);
  EXPECT_EQ(plan.of(Effect::kReflection).cost.cycles_per_hit, 0u);
  config.testers.any_hit = TestersConfig::AnyHit::kShader;
  EXPECT_EQ(plan_effects(scene_of_everything(), config).of(Effect::kAlphaBlend).cost.cycles_per_hit, 11u);
}

TEST(EffectsWork, FollowsFromTheOperationsOfTheMaterial) {
  scene::Scene scene = empty_scene();
  scene::Material coated = matte({1, 1, 1});
  coated.clearcoat.weight = 1;
  coated.clearcoat.texture.emplace();
  scene::Material sheet = matte({1, 1, 1});
  sheet.unlit = true;
  for (const scene::Material& m : {matte({1, 1, 1}), coated, sheet}) {
    const std::uint32_t id = add_material(scene, m);
    add_quad(scene, {-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}, id);
  }
  const std::size_t first = scene.materials.size() - 3;
  const std::vector<ShadeWork> least = extra_work(scene, plan_effects(scene, small_image()));
  EXPECT_EQ(least[first], (ShadeWork{0, 0}));
  EXPECT_EQ(least[first + 1], (ShadeWork{1, 214}));
  EXPECT_EQ(least[first + 2], (ShadeWork{0, 0}));
  // With `all` the code evaluates both layers everywhere, and checks the twelve other effects that have products.
  const std::vector<ShadeWork> most = extra_work(scene, plan_effects(scene, small_image(Choice::kAll)));
  EXPECT_EQ(most[first], (ShadeWork{0, 214 + 242 + 12}));
  EXPECT_EQ(most[first + 1], (ShadeWork{1, 214 + 242 + 12}));
  EXPECT_EQ(most[first + 2], (ShadeWork{0, 14}));
  EXPECT_EQ(extra_work_of_misses(plan_effects(scene, small_image())), (ShadeWork{0, 0}));
  EXPECT_EQ(extra_work_of_misses(plan_effects(scene, small_image(Choice::kAll))), (ShadeWork{0, 1}));

  // Light is drawn from a map at each lit surface, and rays that leave the scene look at it.
  scene.sky.map = {"map", 1, 1, {Vec3{1}}, 0};
  for (const Choice choice : {Choice::kAuto, Choice::kAll}) {
    const EffectsPlan plan = plan_effects(scene, small_image(choice));
    const std::vector<ShadeWork> lit = extra_work(scene, plan);
    EXPECT_EQ(lit[first], (choice == Choice::kAuto ? ShadeWork{1, 104} : ShadeWork{1, 104 + 214 + 242 + 11}));
    EXPECT_EQ(lit[first + 1].lookups, 2u);
    EXPECT_EQ(lit[first + 2].lookups, 0u);
    EXPECT_EQ(extra_work_of_misses(plan), (ShadeWork{1, 77}));
  }
  const EffectsPlan shadowless = plan_effects(scene, small_image(Choice::kList, {"environment_map"}));
  EXPECT_EQ(extra_work(scene, shadowless)[first], (ShadeWork{0, 0}));
  EXPECT_EQ(extra_work_of_misses(shadowless), (ShadeWork{1, 77}));
}

TEST(EffectsPlan, PicturesOfEverythingDoNotDependOnWorkersOrOrder) {
  const scene::Scene scene = scene_of_everything();
  const AlphaTest alpha(scene);
  const BruteForceTracer tracer(scene, &alpha);
  const Picture expected = picture(scene, small_image());
  for (const Choice choice : {Choice::kAuto, Choice::kAll}) {
    PathTracer many(scene, small_image(choice), 70, 3);
    run_unruly_frame(many, tracer, 3, 20, 5);
    EXPECT_EQ(many.image_digest(), expected.image);
    EXPECT_EQ(many.hits_digest().hex(), expected.hits);
  }
}

/// Radiance seen straight down through a box of glass of `thickness` and index 1.5 under a sky of radiance 1.
double through_glass(float thickness, const Vec3& color, float distance, int channel) {
  scene::Scene scene = empty_scene();
  scene::Material glass = matte({1, 1, 1});
  glass.roughness = 0;
  glass.transmission.weight = 1;
  glass.volume = {
      .thickness = 1, .thickness_texture = {}, .attenuation_color = color, .attenuation_distance = distance};
  const std::uint32_t m = add_material(scene, glass);
  const float h = thickness / 2;
  add_quad(scene, {-9, h, 9}, {9, h, 9}, {9, h, -9}, {-9, h, -9}, m);
  add_quad(scene, {-9, -h, -9}, {9, -h, -9}, {9, -h, 9}, {-9, -h, 9}, m);
  scene.sky.radiance = Vec3{1};
  scene.cameras[0] = looking_down(5, 0.5f);
  Config config;
  config.image = {32, 32, 64, 12, 1};
  const Picture p = picture(scene, config);
  double sum = 0;
  for (std::size_t i = std::size_t(channel); i < p.rgb.size(); i += 3) sum += p.rgb[i];
  return sum / (32 * 32);
}

TEST(Volume, TakesLightAsBeerAndLambertSay) {
  EXPECT_NEAR(through_glass(1, Vec3{1}, 1, 0), 1.0, 0.01);  // clear glass in a white world is invisible
  const Vec3 color{0.25f, 0.5f, 0.9f};
  for (const float thickness : {0.5f, 1.5f}) {
    for (int c = 0; c < 3; ++c) {
      // At normal incidence each boundary reflects r and the slab transmits t; light is reflected back and forth in it.
      const double t = std::pow(double{color[c]}, double{thickness} / 0.8), r = 0.04;
      const double expected = r + (1 - r) * (1 - r) * t / (1 - r * t);
      EXPECT_NEAR(through_glass(thickness, color, 0.8f, c), expected, 0.01) << thickness << " " << c;
    }
  }
}

/// Adds a horizontal slab of an absorbing volume that neither reflects nor refracts, wide enough to fill the view.
void add_slab(scene::Scene& scene, float bottom, float top, const Vec3& color) {
  scene::Material m = matte({1, 1, 1});
  m.roughness = 0;
  m.ior = 1;
  m.transmission.weight = 1;
  m.volume = {.thickness = 1, .thickness_texture = {}, .attenuation_color = color, .attenuation_distance = 1};
  const std::uint32_t index = add_material(scene, m);
  add_quad(scene, {-9, top, 9}, {9, top, 9}, {9, top, -9}, {-9, top, -9}, index);
  add_quad(scene, {-9, bottom, -9}, {9, bottom, -9}, {9, bottom, 9}, {-9, bottom, 9}, index);
}

TEST(Volume, NestsAndIsLeftIntoTheOneAround) {
  const Vec3 outer{0.9f, 0.5f, 0.7f}, middle{0.6f, 0.8f, 0.9f}, inner{0.5f, 0.9f, 0.4f};
  scene::Scene scene = empty_scene();
  add_slab(scene, -2, 2, outer);  // 1 above the next, 1 below it
  add_slab(scene, -1, 1, middle);
  add_slab(scene, -0.25f, 0.25f, inner);
  scene.sky.radiance = Vec3{1};
  scene.cameras[0] = looking_down(5, 0.05f);
  Config config;
  config.image = {16, 16, 64, 12, 1};
  const Picture p = picture(scene, config);
  double means[3] = {};  // paths end early by chance
  for (std::size_t i = 0; i < p.rgb.size(); ++i) means[i % 3] += p.rgb[i] / (double(p.rgb.size()) / 3);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(means[c],
                std::pow(double{outer[c]}, 2.0) * std::pow(double{middle[c]}, 1.5) * std::sqrt(double{inner[c]}), 0.01)
        << c;
}

TEST(VolumeStack, KeepsTheOuterVolumesInAnyOrderOfLeaving) {
  VolumeStack stack;
  stack.leave(3);  // never entered
  EXPECT_EQ(stack.innermost(), 0u);
  for (const std::uint32_t m : {7u, 3u, 5u, 3u}) stack.enter(m);
  stack.enter(9);  // no room
  EXPECT_EQ(stack.innermost(), 4u);
  stack.leave(9);
  stack.leave(5);  // overlapping hulls
  EXPECT_EQ(stack.innermost(), 4u);
  stack.leave(3);
  EXPECT_EQ(stack.innermost(), 4u);
  stack.leave(3);
  EXPECT_EQ(stack.innermost(), 8u);
  stack.leave(7);
  EXPECT_EQ(stack.innermost(), 0u);
}

TEST(PathTracer, LightPassesAWindowTwice) {
  // A matte floor under a thin clear wall in a white world: the picture depends only on the wall's reflection and
  // transmission.
  scene::Scene scene = empty_scene();
  scene::Material wall = matte({1, 1, 1});
  wall.roughness = 0.1f;
  wall.transmission.weight = 1;
  add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add_material(scene, matte({1, 1, 1})));
  add_quad(scene, {-9, 1, 9}, {9, 1, 9}, {9, 1, -9}, {-9, 1, -9}, add_material(scene, wall));
  scene.sky.radiance = Vec3{1};
  scene.cameras[0] = looking_down(5, 0.5f);
  Config config;
  config.image = {24, 24, 64, 60, 1};
  const Picture p = picture(scene, config);
  double mean = 0;
  for (const float c : p.rgb) mean += c / double(p.rgb.size());
  EXPECT_NEAR(mean, 1.0, 0.02);
}

TEST(PathTracer, BouncesAndShadowRaysFindTheSameLightThroughGlass) {
  // Compares multiple importance sampling on both sides of a rough boundary with a picture without shadow rays.
  scene::Material glass = matte({1, 1, 1});
  glass.roughness = 0.6f;
  glass.transmission.weight = 1;
  glass.volume.thickness = 1;
  const scene::Scene scene = box_on_floor(glass);
  Config config;
  config.image = {12, 12, 512, 12, 5};
  const Picture both = picture(scene, config);
  config.shading.effects = {Choice::kList, all_but(Effect::kShadowRays)};
  const Picture bounces = picture(scene, config);
  double a = 0, b = 0;
  for (std::size_t i = 0; i < both.rgb.size(); ++i) {
    a += both.rgb[i] / double(both.rgb.size());
    b += bounces.rgb[i] / double(both.rgb.size());
  }
  EXPECT_NEAR(a, b, 0.03 * a);
}

}  // namespace
}  // namespace carousel::shading
