#pragma once

#include <cstdint>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::shading {

// Scenes of a few triangles for the tests.

inline std::uint32_t add_material(scene::Scene& scene, const scene::Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

inline scene::Material matte(const Vec3& color) {
  scene::Material m;
  m.base_color = Vec4(color, 1.0f);
  m.metallic = 0;
  m.roughness = 1;
  return m;
}

inline scene::Material emissive_material(const Vec3& radiance) {
  scene::Material m = matte(Vec3{0});
  m.emissive = radiance;
  return m;
}

/// A mesh of its own with one instance.
inline void add_mesh(scene::Scene& scene, std::vector<Vec3> positions, std::vector<std::uint32_t> indices,
                     std::uint32_t material, const scene::Affine& placement = {}) {
  scene::Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.indices = std::move(indices);
  mesh.triangle_materials.assign(mesh.triangle_count(), MaterialId(material));
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({MeshId(static_cast<std::uint32_t>(scene.meshes.size() - 1)), placement});
}

/// A mesh of its own with one instance.
inline void add_sphere(scene::Scene& scene, const Vec3& center, float radius, std::uint32_t material,
                       const scene::Affine& placement = {}) {
  scene::Mesh mesh;
  mesh.spheres.push_back({center, radius, MaterialId(material)});
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({MeshId(static_cast<std::uint32_t>(scene.meshes.size() - 1)), placement});
}

/// Corners counter-clockwise as seen from the front.
inline void add_quad(scene::Scene& scene, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                     std::uint32_t material) {
  add_mesh(scene, {a, b, c, d}, {0, 1, 2, 0, 2, 3}, material);
}

inline scene::Scene empty_scene() {
  scene::Scene scene;
  scene.cameras.emplace_back();
  return scene;
}

/// A camera that looks straight down on the origin from (0, height, 0) through a window of `half_size`.
inline scene::Camera looking_down(float height, float half_size) {
  scene::Camera camera;
  camera.projection = scene::Camera::Projection::kOrthographic;
  camera.position = {0, height, 0};
  camera.right = {1, 0, 0};
  camera.up = {0, 0, -1};
  camera.back = {0, 1, 0};
  camera.xmag = camera.ymag = half_size;
  return camera;
}

/// A floor, a metal pyramid (one placement mirrored), an emissive quad, a point, a spot and a directional light, a sky:
/// every kind of ray and light.
inline scene::Scene mixed_scene() {
  scene::Scene scene = empty_scene();
  const std::uint32_t white = add_material(scene, matte({0.8f, 0.7f, 0.6f}));
  const std::uint32_t light = add_material(scene, emissive_material({9, 8, 7}));
  scene::Material metal;
  metal.base_color = {0.9f, 0.6f, 0.3f, 1};
  metal.roughness = 0.3f;
  metal.double_sided = true;
  const std::uint32_t gold = add_material(scene, metal);
  add_quad(scene, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, white);
  add_quad(scene, {-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}, light);
  const std::vector<Vec3> pyramid{{-1, 0, 1}, {1, 0, 1}, {0, 0, -1}, {0, 1.5f, 0}};
  add_mesh(scene, pyramid, {0, 1, 3, 1, 2, 3, 2, 0, 3}, gold, {Mat3(0.7f), {-1, 0, 0}});
  add_mesh(scene, pyramid, {0, 1, 3, 1, 2, 3, 2, 0, 3}, white,
           {Mat3(-0.5f, 0, 0.1f, 0, 0.9f, 0, 0, 0.2f, 0.6f), {1, 0.1f, 0.5f}});
  using Kind = scene::PunctualLight::Kind;
  scene::PunctualLight point, spot, sun;
  point.position = {2, 2, 2};
  point.intensity = {1, 2, 3};
  point.range = 10;
  spot.kind = Kind::kSpot;
  spot.position = {-2, 2, 2};
  spot.direction = {0.57735f, -0.57735f, -0.57735f};
  spot.intensity = {8, 4, 2};
  spot.inner_cone_cos = 0.9f;
  sun.kind = Kind::kDirectional;
  sun.direction = {0.6f, -0.8f, 0};
  sun.intensity = Vec3{0.3f};
  scene.lights = {point, spot, sun};
  scene.sky.radiance = {0.2f, 0.3f, 0.5f};
  scene.cameras[0].position = {0, 1.2f, 5};
  return scene;
}

}  // namespace carousel::shading
