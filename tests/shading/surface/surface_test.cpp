#include "shading/surface/surface.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/octahedral.h"
#include "shading/lights/emissive_primitives.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {
namespace {

/// One triangle in the xy plane, its front towards +z, with texture coordinates like glTF's: v points down.
scene::Scene triangle(const scene::Material& material, const scene::Affine& placement = {}) {
  scene::Scene scene = empty_scene();
  add_material(scene, material);
  add_mesh(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}, 0, placement);
  scene.meshes[0].uv0 = {{0, 1}, {1, 1}, {0, 0}};
  return scene;
}

TextureId add_texel(scene::Scene& scene, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  scene.images.push_back({"texel", 1, 1, {r, g, b, 255}});
  scene.textures.push_back({ImageId(std::uint32_t(scene.images.size() - 1)), {}, {}, true});
  return TextureId(std::uint32_t(scene.textures.size() - 1));
}

Vec3 normal_at(const scene::Scene& scene, float u, float v, const Vec3& wo) {
  const TriangleGeometry g = triangle_geometry(scene, 0, 0, u, v);
  const bool front = glm::dot(g.normal, DVec3(wo)) >= 0;
  return shading_normal(scene, triangle_point(scene, 0, 0, u, v), g, Vec3(front ? g.normal : -g.normal), front, wo);
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(Surface, MultipliesFactorTextureAndVertexColour) {
  scene::Scene scene = triangle(matte({0.5f, 1.0f, 1.0f}));
  scene.materials[0].base_color_texture = scene::TextureUse{add_texel(scene, 255, 255, 0), 0, {}, {1, 1}, 0};
  scene.meshes[0].colors = {{1, 1, 1, 1}, {0, 1, 1, 1}, {1, 0.5f, 1, 1}};
  expect_near(base_color(scene, triangle_point(scene, 0, 0, 0.5f, 0)), {0.25f, 1, 0});
  expect_near(base_color(scene, triangle_point(scene, 0, 0, 0, 1)), {0.5f, 0.5f, 0});
}

TEST(Surface, ReadsRoughnessFromGreenAndMetallicFromBlue) {
  scene::Scene scene = triangle(matte(Vec3{1}));
  scene.materials[0].metallic = 1;
  scene.materials[0].metallic_roughness_texture = scene::TextureUse{add_texel(scene, 9, 51, 204), 0, {}, {1, 1}, 0};
  const MaterialPoint m = material_point(scene, triangle_point(scene, 0, 0, 0.2f, 0.2f));
  EXPECT_NEAR(m.roughness, 0.2f, 1e-6f);
  EXPECT_NEAR(m.metallic, 0.8f, 1e-6f);
}

TEST(Surface, NormalsFaceTheViewer) {
  const scene::Scene scene = triangle(matte(Vec3{1}));
  expect_near(normal_at(scene, 0.2f, 0.2f, {0, 0, 1}), {0, 0, 1});
  expect_near(normal_at(scene, 0.2f, 0.2f, {0, 0, -1}), {0, 0, -1});
}

TEST(Surface, NormalsAreInterpolated) {
  scene::Scene scene = triangle(matte(Vec3{1}));
  scene.meshes[0].normals = {{0, 0, 1}, glm::normalize(Vec3{1, 0, 1}), {0, 0, 1}};
  expect_near(normal_at(scene, 0, 0.5f, {0, 0, 1}), {0, 0, 1});
  expect_near(normal_at(scene, 1, 0, {0, 0, 1}), glm::normalize(Vec3{1, 0, 1}));
  expect_near(normal_at(scene, 1, 0, {0, 0, -1}), -glm::normalize(Vec3{1, 0, 1}));
}

TEST(Surface, NormalsStayPerpendicularUnderUnequalScaleAndMirroring) {
  // A slope of 45 degrees, stretched threefold in x.
  for (const float mirror : {1.0f, -1.0f}) {
    const scene::Affine placement{Mat3(3 * mirror, 0, 0, 0, 1, 0, 0, 0, 1), {5, 6, 7}};
    scene::Scene scene = triangle(matte(Vec3{1}), placement);
    scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 1}, {0, 1, 0}};
    const Vec3 n = glm::normalize(Vec3{-1, 0, 1});
    scene.meshes[0].normals = {n, n, n};
    const Vec3 expected = glm::normalize(Vec3{-mirror, 0, 3});
    expect_near(normal_at(scene, 0.2f, 0.2f, {0, 0, 1}), expected);
    scene.meshes[0].normals.clear();
    expect_near(normal_at(scene, 0.2f, 0.2f, {0, 0, 1}), expected);
  }
}

TEST(Surface, NormalMapBendsAlongUAndAgainstV) {
  scene::Scene scene = triangle(matte(Vec3{1}));
  scene.materials[0].normal_texture = scene::TextureUse{add_texel(scene, 255, 128, 128), 0, {}, {1, 1}, 0};
  Vec3 n = normal_at(scene, 0.2f, 0.2f, glm::normalize(Vec3{1, 0, 1}));
  EXPECT_GT(n.x, 0.99f);  // +u is +x here
  scene.materials[0].normal_texture = scene::TextureUse{add_texel(scene, 128, 255, 128), 0, {}, {1, 1}, 0};
  n = normal_at(scene, 0.2f, 0.2f, glm::normalize(Vec3{0, 1, 1}));
  EXPECT_GT(n.y, 0.99f);  // the top of the image is +y here
  scene.materials[0].normal_scale = 0;
  expect_near(normal_at(scene, 0.2f, 0.2f, {0, 0, 1}), {0, 0, 1});
}

TEST(Surface, ShadingNormalsAreTurnedUntilTheViewerIsAboveTheHorizon) {
  scene::Scene scene = triangle(matte(Vec3{1}));
  const Vec3 tilted = glm::normalize(Vec3{-1, 0, 0.5f});
  scene.meshes[0].normals = {tilted, tilted, tilted};
  const Vec3 wo = glm::normalize(Vec3{1, 0, 0.1f});
  EXPECT_GT(glm::dot(normal_at(scene, 0.2f, 0.2f, wo), wo), 0.0f);
}

TEST(Surface, ASphereHasLongitudeAndLatitude) {
  scene::Scene scene = empty_scene();
  scene::Material material = matte(Vec3{1});
  material.base_color_texture.emplace();
  add_sphere(scene, {5, 5, 5}, 2, add_material(scene, material));
  // Left and right columns, top and bottom rows.
  scene.images.push_back({"four", 2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}});
  scene.textures.push_back({ImageId(0), {}, {}, false});
  const auto color = [&](const DVec3& n) {
    const Vec2 at = octahedral(glm::normalize(n));
    return base_color(scene, triangle_point(scene, 0, 0, at.x, at.y));
  };
  expect_near(color({-1, 0.5, 0}), {1, 0, 0});
  expect_near(color({1, 0.5, 0}), {0, 1, 0});
  expect_near(color({-1, -0.5, 0.5}), {0, 0, 1});
  expect_near(color({1, -0.5, -0.5}), {1, 1, 1});
}

TEST(EmissivePrimitives, AreMeasuredWhereTheyStand) {
  scene::Scene scene = triangle(emissive_material({1, 1, 1}), {Mat3(2.0f), {0, 0, 9}});
  scene.instances.push_back({MeshId(0), {}});
  const EmissivePrimitives lights(scene);
  ASSERT_EQ(lights.all().size(), 2u);
  EXPECT_FLOAT_EQ(lights.all()[0].area, 2.0f);
  EXPECT_FLOAT_EQ(lights.all()[1].area, 0.5f);
  EXPECT_NEAR(lights.all()[1].flux, 0.5f * 3.14159265f, 1e-4f);
  EXPECT_EQ(lights.index_of(scene, 1, 0), 1u);
}

TEST(EmissivePrimitives, KnowWhatTheirTextureLeavesDark) {
  scene::Scene scene = triangle(emissive_material({1, 1, 1}));
  scene.materials[0].emissive_texture = scene::TextureUse{add_texel(scene, 0, 0, 0), 0, {}, {1, 1}, 0};
  EXPECT_EQ(EmissivePrimitives(scene).all()[0].flux, 0.0f);
  scene.materials[0].unlit = true;
  EXPECT_TRUE(EmissivePrimitives(scene).all().empty());
}

}  // namespace
}  // namespace carousel::shading
