#include "shading/lights/light_set.h"

#include <cmath>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/octahedral.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/trigonometry.h"
#include "shading/tracer/path_tracer.h"
#include "tests/shading/path/brute_force_tracer.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {
namespace {

/// Irradiance at `p` with normal `n` from a polygon of unit radiance that is wholly above the horizon:
/// J. H. Lambert, "Photometria", 1760.
double polygon_irradiance(const std::vector<DVec3>& polygon, const DVec3& p, const DVec3& n) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const DVec3 a = glm::normalize(polygon[i] - p), b = glm::normalize(polygon[(i + 1) % polygon.size()] - p);
    const DVec3 axis = glm::cross(a, b);
    sum += std::acos(glm::dot(a, b)) * glm::dot(axis / glm::length(axis), n);
  }
  return std::abs(0.5 * sum);
}

double sampled_irradiance(const LightSet& lights, const Vec3& p, const Vec3& n) {
  constexpr std::uint32_t kSamples = 1 << 14;
  const Sampler sampler(3, kSamples);
  double sum = 0;
  for (std::uint32_t s = 0; s < kSamples; ++s) {
    const LightSample light = lights.sample(sampler.light(0, s, 0), p, SpawnOffset::kBound);
    sum += double{light.radiance.x} * std::max(0.0f, glm::dot(n, light.wi));
  }
  return sum / kSamples;
}

TEST(LightSet, RectangleGivesTheFormFactorsIrradiance) {
  scene::Scene scene = empty_scene();
  const std::uint32_t light = add_material(scene, emissive_material(Vec3{1}));
  add_quad(scene, {-1, 2, -0.5f}, {1, 2, -0.5f}, {1, 2, 0.5f}, {-1, 2, 0.5f}, light);  // looks down
  const LightSet lights(scene);
  const std::vector<DVec3> polygon{{-1, 2, -0.5}, {1, 2, -0.5}, {1, 2, 0.5}, {-1, 2, 0.5}};
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1.5f, 0.5f, -1}, Vec3{0.3f, 1.7f, 0.2f}}) {
    const double expected = polygon_irradiance(polygon, DVec3(p), {0, 1, 0});
    EXPECT_NEAR(sampled_irradiance(lights, p, {0, 1, 0}), expected, 0.01 * expected);
  }
  EXPECT_EQ(sampled_irradiance(lights, {0, 3, 0}, {0, -1, 0}), 0.0);  // nothing behind it
}

TEST(LightSet, InstancedAndMirroredTrianglesGiveTheFormFactorsIrradiance) {
  scene::Scene scene = empty_scene();
  const std::uint32_t light = add_material(scene, emissive_material(Vec3{1}));
  const scene::Affine placement{Mat3(-2, 0, 0, 0, 1, 0, 0, 0, 0.5f), {0.5f, 3, 0}};
  add_mesh(scene, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}}, {0, 1, 2}, light, placement);
  const LightSet lights(scene);
  std::vector<DVec3> polygon;
  for (const Vec3& v : scene.meshes[0].positions) polygon.emplace_back(placement.linear * v + placement.translation);
  const double expected = polygon_irradiance(polygon, {0, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(sampled_irradiance(lights, {0, 0, 0}, {0, 1, 0}), expected, 0.01 * expected);
}

TEST(LightSet, ASphereGivesTheIrradianceOfItsDisk) {
  scene::Scene scene = empty_scene();
  add_sphere(scene, {0, 3, 0}, 1, add_material(scene, emissive_material(Vec3{1})));
  const LightSet lights(scene);
  // pi (r / d)^2 cos, however near, as long as all of it is above the horizon.
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0, 1.9f, 0}, Vec3{4, 0, 1}}) {
    const double d2 = glm::dot(DVec3(0, 3, 0) - DVec3(p), DVec3(0, 3, 0) - DVec3(p));
    const double expected = 3.14159265358979 / d2 * (3.0 - p.y) / std::sqrt(d2);
    EXPECT_NEAR(sampled_irradiance(lights, p, {0, 1, 0}), expected, 0.01 * expected);
  }
  EXPECT_EQ(sampled_irradiance(lights, {0, 3.2f, 0}, {0, 1, 0}), 0.0);  // its inside is dark
  scene.materials[0].double_sided = true;
  EXPECT_NEAR(sampled_irradiance(LightSet(scene), {0, 3.2f, 0}, {0, 1, 0}), 3.14159265358979, 0.03);
}

/// The first crossing of a ray of direction `d` from `p` with the unit sphere that `m` has stretched.
std::optional<Hit> meet_ellipsoid(const scene::Affine& m, const Vec3& p, const Vec3& d) {
  const DMat3 back = glm::inverse(DMat3(m.linear));
  const DVec3 o = back * (DVec3(p) - DVec3(m.translation)), v = back * DVec3(d);
  const double a = glm::dot(v, v), b = glm::dot(o, v), c = glm::dot(o, o) - 1, root = b * b - a * c;
  if (root < 0 || b > 0) return std::nullopt;
  const double t = (-b - std::sqrt(root)) / a;
  const Vec2 at = octahedral(o + t * v);
  return Hit{float(t), at.x, at.y, 0, 0};
}

TEST(LightSet, DensityOfAMetEllipsoidIsTheDensityOfChoosingIt) {
  scene::Scene scene = empty_scene();
  const scene::Affine stretched{Mat3(2, 0.3f, 0, 0, 0.5f, 0, 0, 0, -1), {0, 3, 1}};
  add_sphere(scene, {0, 0, 0}, 1, add_material(scene, emissive_material(Vec3{1})), stretched);
  const LightSet lights(scene);
  const Vec3 p{0.5f, 0.2f, -0.3f};
  constexpr std::uint32_t kDirections = 1 << 16;
  const Sampler sampler(4, kDirections);
  double share = 0, irradiance = 0;
  int chosen = 0;
  for (std::uint32_t s = 0; s < kDirections; ++s) {
    const Vec2 u = sampler.direction(0, s, 0).direction;
    const SinCos turn = sin_cos_turns(u.y);
    const float sine = std::sqrt(1 - u.x * u.x);
    const Vec3 d{sine * turn.cos, u.x, sine * turn.sin};  // even over the hemisphere above
    if (const std::optional<Hit> hit = meet_ellipsoid(stretched, p, d)) {
      const TriangleGeometry geometry = triangle_geometry(scene, 0, 0, hit->u, hit->v);
      const auto cosine = float(-glm::dot(geometry.normal, DVec3(d)));
      share += 2 * kPi / kDirections * double{lights.primitive_pdf(*hit, geometry, true, cosine)};
      irradiance += 2 * kPi / kDirections * double{d.y};
    }
    chosen += lights.sample(sampler.light(0, s, 0), p, SpawnOffset::kBound).pdf > 0 ? 1 : 0;
  }
  EXPECT_NEAR(share, double(chosen) / kDirections, 0.01);
  EXPECT_NEAR(sampled_irradiance(lights, p, {0, 1, 0}), irradiance, 0.02 * irradiance);
}

TEST(LightSet, DensityOfAMetTriangleIsTheDensityOfChoosingIt) {
  scene::Scene scene = mixed_scene();
  const LightSet lights(scene);
  const BruteForceTracer tracer(scene);
  const Sampler sampler(1, 500);
  const Vec3 p{0.2f, 0.01f, 1.5f};
  int compared = 0;
  for (std::uint32_t s = 0; s < 500; ++s) {
    const LightSample light = lights.sample(sampler.light(0, s, 0), p, SpawnOffset::kBound);
    if (light.pdf == 0.0f) continue;
    const Hit hit = tracer.trace({p, 0, light.wi, kInfinity}, {});
    if (!hit.valid() || scene.instances[hit.instance].mesh.value != 1) continue;
    const float pdf = lights.primitive_pdf(hit, triangle_geometry(scene, hit.instance, hit.primitive, hit.u, hit.v),
                                           true, std::abs(light.wi.y));
    EXPECT_NEAR(pdf, light.pdf, 1e-3f * light.pdf);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(LightSet, PointLightFallsOffWithTheSquareUpToItsRange) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte(Vec3{1}));
  scene::PunctualLight light;
  light.intensity = Vec3{8};
  light.position = {0, 2, 0};
  scene.lights = {light};
  EXPECT_NEAR(sampled_irradiance(LightSet(scene), {0, 0, 0}, {0, 1, 0}), 2.0, 1e-5);
  EXPECT_NEAR(sampled_irradiance(LightSet(scene), {2, 0, 0}, {0, 1, 0}), std::sqrt(0.5), 1e-5);
  scene.lights[0].range = 4;
  EXPECT_NEAR(sampled_irradiance(LightSet(scene), {0, 0, 0}, {0, 1, 0}), 2.0 * (1 - 1.0 / 16), 1e-5);
  EXPECT_EQ(sampled_irradiance(LightSet(scene), {0, -2, 0}, {0, 1, 0}), 0.0);
}

TEST(LightSet, SpotLightStaysInItsCone) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte(Vec3{1}));
  scene::PunctualLight light;
  light.kind = scene::PunctualLight::Kind::kSpot;
  light.intensity = Vec3{4};
  light.position = {0, 2, 0};
  light.direction = {0, -1, 0};
  light.inner_cone_cos = 0.95f;
  light.outer_cone_cos = 0.8f;
  scene.lights = {light};
  const LightSet lights(scene);
  EXPECT_NEAR(sampled_irradiance(lights, {0, 0, 0}, {0, 1, 0}), 1.0, 1e-5);
  EXPECT_EQ(sampled_irradiance(lights, {1.6f, 0, 0}, {0, 1, 0}), 0.0);
  EXPECT_GT(sampled_irradiance(lights, {1.0f, 0, 0}, {0, 1, 0}), 0.0);
}

TEST(LightSet, DirectionalLightIsTheSameEverywhere) {
  scene::Scene scene = empty_scene();
  const std::uint32_t white = add_material(scene, matte(Vec3{1}));
  add_quad(scene, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::kDirectional;
  sun.direction = {0, -1, 0};
  sun.intensity = Vec3{3};
  scene.lights = {sun};
  EXPECT_NEAR(sampled_irradiance(LightSet(scene), {5, 0, 9}, {0, 1, 0}), 3.0, 1e-5);
}

TEST(LightSet, ASceneWithoutLightIsEmpty) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte(Vec3{1}));
  EXPECT_TRUE(LightSet(scene).empty());
}

TEST(LightSet, BounceRaysAndShadowRaysFindTheSameLight) {
  // A big emissive quad close above a glossy floor: with two surfaces both techniques count, with one only shadow rays.
  for (const float roughness : {0.3f, 1.0f}) {
    scene::Scene scene = empty_scene();
    scene::Material floor = matte({0.6f, 0.6f, 0.6f});
    floor.roughness = roughness;
    const std::uint32_t grey = add_material(scene, floor), light = add_material(scene, emissive_material(Vec3{2}));
    add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, grey);
    add_quad(scene, {0.5f, 1, -2}, {3, 1, -2}, {3, 1, 2}, {0.5f, 1, 2}, light);
    scene.cameras[0] = looking_down(0.9f, 0.4f);
    const BruteForceTracer tracer(scene);
    double mean[2];
    for (const int depth : {1, 2}) {
      Config config;
      config.image = {16, 16, 64, depth, 4};
      PathTracer frame(scene, config, 1000, 1);
      run_frame(frame, tracer, 1000);
      mean[depth - 1] = 0;
      for (const float c : frame.linear_rgb()) mean[depth - 1] += c / (3.0 * 256);
    }
    EXPECT_GT(mean[0], 0.01);
    EXPECT_NEAR(mean[1], mean[0], 0.01 * mean[0]) << roughness;
  }
}

}  // namespace
}  // namespace carousel::shading
