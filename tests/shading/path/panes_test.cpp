// Light through thin, smooth walls: by shadow rays that pass them, and by paths that go straight on.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shading/effects/effects_plan.h"
#include "shading/tracer/path_tracer.h"
#include "tests/shading/path/brute_force_tracer.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {
namespace {

Config left_out(Config config, Effect effect) {
  config.shading.effects.choice = ShadingConfig::Effects::Choice::kList;
  for (const std::string_view name : kEffectNames)
    if (name != effect_name(effect)) config.shading.effects.names.emplace_back(name);
  return config;
}

std::vector<float> light_of(scene::Scene scene, const Config& config) {
  strip_effects(scene, config.shading.effects);
  PathTracer tracer(scene, config, 1000, 1);
  run_frame(tracer, BruteForceTracer(scene), 200);
  return tracer.linear_rgb();
}

double mean_of(const std::vector<float>& rgb) {
  double sum = 0;
  for (const float c : rgb) sum += c / double(rgb.size());
  return sum;
}

/// The mean of the squared differences to the mean, over the mean squared.
double noise_of(const std::vector<float>& rgb) {
  const double m = mean_of(rgb);
  double sum = 0;
  for (const float c : rgb) sum += (c - m) * (c - m) / double(rgb.size());
  return sum / (m * m);
}

scene::Material clear_wall(const Vec3& color, float transmission = 1) {
  scene::Material wall = matte(color);
  wall.roughness = 0;
  wall.transmission.weight = transmission;
  return wall;
}

void add_ceiling(scene::Scene& scene, float height, float half, std::uint32_t material) {
  add_quad(scene, {-half, height, -half}, {half, height, -half}, {half, height, half}, {-half, height, half}, material);
}

/// A white floor at y = 0, seen from just above it, below panes at y = 1, 2 and so on.
scene::Scene floor_below(const std::vector<Vec3>& panes) {
  scene::Scene scene = empty_scene();
  scene::Material white = matte({1, 1, 1});
  white.specular.weight = 0;  // all of its light comes from below the surface
  add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add_material(scene, white));
  for (std::size_t i = 0; i < panes.size(); ++i)
    add_ceiling(scene, 1 + static_cast<float>(i), 9, add_material(scene, clear_wall(panes[i])));
  scene.cameras[0] = looking_down(0.5f, 0.25f);
  return scene;
}

void add_sun(scene::Scene& scene, float irradiance, const Vec3& direction = {0, -1, 0}) {
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::kDirectional;
  sun.intensity = Vec3{irradiance};
  sun.direction = direction;
  scene.lights.push_back(sun);
}

TEST(TransparentShadows, APaneColoursTheSunByHand) {
  const Vec3 red{0.9f, 0.5f, 0.2f}, blue{0.3f, 0.6f, 1.0f};
  scene::Scene one = floor_below({red}), two = floor_below({red, blue});
  add_sun(one, 2);
  add_sun(two, 2);
  Config config;
  config.image = {2, 2, 2, 3, 1};
  // At normal incidence a wall of index 1.5 reflects 4 % of the light; the floor sends back a pi-th.
  const double lit = 2 / 3.14159265358979, clear = 0.96;
  const std::vector<float> once = light_of(one, config);
  for (std::size_t i = 0; i < once.size(); ++i) {
    const double expected = lit * clear * red[int(i % 3)];  // the pane is taken for as rough as a bounce would find it
    EXPECT_NEAR(once[i], expected, 0.005 * expected) << i;
  }
  for (const float c : light_of(two, config)) EXPECT_EQ(c, 0.0f);  // floor and two panes are a surface too many
  config.image.max_depth = 4;
  const Vec3 both = red * blue;
  double channels[3] = {};
  const std::vector<float> deep = light_of(two, config);
  for (std::size_t i = 0; i < deep.size(); ++i) channels[i % 3] += deep[i] / (double(deep.size()) / 3);
  // From the fourth surface on, the panes also reflect a little of the floor's own light.
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(channels[c], lit * clear * clear * both[c] * 0.9999) << c;
    EXPECT_LT(channels[c], lit * clear * clear * both[c] * 1.2) << c;
  }
}

TEST(TransparentShadows, BouncesAndShadowRaysFindTheSameLightThroughPanes) {
  for (const float transmission : {1.0f, 0.6f}) {
    scene::Scene scene = floor_below({});
    add_ceiling(scene, 1, 9, add_material(scene, clear_wall({0.9f, 0.7f, 0.5f}, transmission)));
    add_ceiling(scene, 1.5f, 9, add_material(scene, clear_wall({0.8f, 0.9f, 0.9f})));
    add_ceiling(scene, 3, 1.5f, add_material(scene, emissive_material({3, 3, 3})));
    Config config;
    config.image = {12, 12, 256, 7, 5};
    const double both = mean_of(light_of(scene, config)),
                 bounces = mean_of(light_of(scene, left_out(config, Effect::kShadowRays)));
    EXPECT_GT(both, 0.1);
    EXPECT_NEAR(both, bounces, 0.02 * both) << transmission;
  }
}

TEST(TransparentShadows, TakeTheNoiseOutOfTheLightBehindAWindow) {
  scene::Scene scene = floor_below({{0.95f, 0.95f, 0.95f}});
  add_ceiling(scene, 3, 0.3f, add_material(scene, emissive_material({90, 90, 90})));
  Config config;
  config.image = {16, 16, 16, 5, 5};
  const std::vector<float> with = light_of(scene, config),
                           before = light_of(scene, left_out(config, Effect::kTransparentShadows));
  EXPECT_NEAR(mean_of(with), mean_of(before), 0.15 * mean_of(with));
  EXPECT_LT(20 * noise_of(with), noise_of(before));
}

TEST(TransparentShadows, AClearPaneInAWhiteWorldIsInvisible) {
  scene::Scene scene = empty_scene();
  add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add_material(scene, matte({1, 1, 1})));
  add_ceiling(scene, 1, 9, add_material(scene, clear_wall({1, 1, 1})));
  scene.sky.radiance = Vec3{1};
  add_sun(scene, 0.001f, {0.6f, -0.8f, 0});  // so that there are shadow rays; the pane does not mirror it
  scene.cameras[0] = looking_down(5, 0.5f);
  Config config;
  config.image = {24, 24, 64, 60, 1};
  EXPECT_NEAR(mean_of(light_of(scene, config)), 1.0, 0.02);
}

TEST(TransparentShadows, AreCalledForByThinSmoothWallsAlone) {
  Config config;
  config.image.max_depth = 4;
  const auto plan = [&](const scene::Material& wall, bool sun) {
    scene::Scene scene = floor_below({});
    add_ceiling(scene, 1, 9, add_material(scene, wall));
    if (sun) add_sun(scene, 1);
    return plan_effects(scene, config).of(Effect::kTransparentShadows);
  };
  EXPECT_TRUE(plan(clear_wall({1, 1, 1}), true).on);
  EXPECT_FALSE(plan(clear_wall({1, 1, 1}), false).on);  // no light to sample
  scene::Material frosted = clear_wall({1, 1, 1}), thick = frosted;
  frosted.roughness = 0.3f;
  thick.volume.thickness = 1;
  EXPECT_FALSE(plan(frosted, true).on);
  EXPECT_FALSE(plan(thick, true).on);
  config.image.max_depth = 2;
  EXPECT_FALSE(plan(clear_wall({1, 1, 1}), true).on);
}

}  // namespace
}  // namespace carousel::shading
