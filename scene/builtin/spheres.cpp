#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/builtin/turned.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

// Linear colours that sit well beside each other.
constexpr Vec3 kPalette[] = {{0.80f, 0.10f, 0.06f}, {0.90f, 0.36f, 0.05f}, {0.92f, 0.68f, 0.10f},
                             {0.30f, 0.55f, 0.10f}, {0.05f, 0.45f, 0.38f}, {0.06f, 0.25f, 0.62f},
                             {0.30f, 0.12f, 0.50f}, {0.85f, 0.83f, 0.78f}};
// Reflectances of metals at normal incidence: gold, copper, silver, iron.
constexpr Vec3 kMetals[] = {{1.00f, 0.77f, 0.34f}, {0.96f, 0.64f, 0.54f}, {0.97f, 0.96f, 0.92f}, {0.56f, 0.57f, 0.58f}};

MaterialId add_material(Scene& scene, Vec3 color, float metallic, float roughness) {
  Material m;
  m.name = "sphere " + std::to_string(scene.materials.size());
  m.base_color = Vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  scene.materials.push_back(m);
  return MaterialId(static_cast<std::uint32_t>(scene.materials.size() - 1));
}

std::int64_t triangles_of(int level) {
  return std::int64_t{20} << (2 * level);
}

/// The finest spheres of which there would still be some dozens.
int level_for(std::int64_t triangles) {
  int level = 0;
  while (level < 5 && triangles / triangles_of(level + 1) >= 48) ++level;
  return level;
}

}  // namespace

Scene make_spheres(std::int64_t triangles, std::int64_t seed, bool procedural, float seconds) {
  Scene scene;
  scene.name = "spheres";
  Material ground_material;
  ground_material.name = "ground";
  ground_material.base_color = {0.42f, 0.40f, 0.38f, 1};
  ground_material.metallic = 0;
  ground_material.roughness = 0.9f;
  scene.materials.push_back(ground_material);
  for (const Vec3& color : kPalette) {
    add_material(scene, color, 0, 0.9f);
    add_material(scene, color, 0, 0.25f);
  }
  for (const Vec3& color : kMetals) {
    add_material(scene, color, 1, 0.05f);
    add_material(scene, color, 1, 0.35f);
  }

  const int level = level_for(triangles);
  const std::int64_t count = std::max<std::int64_t>(1, (triangles - 2 + triangles_of(level) / 2) / triangles_of(level));
  const auto side = static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const float half = 0.5f * static_cast<float>(side);

  Mesh field;
  field.name = "spheres";
  HashRandom random(static_cast<std::uint64_t>(seed), 1), speeds(static_cast<std::uint64_t>(seed), 3);
  for (std::int64_t i = 0; i < count; ++i) {
    // One cell a sphere; jitter and radius are bounded so that neighbours never meet.
    const float radius = random.uniform(0.16f, 0.36f) + (random.below(8) == 0 ? 0.1f : 0.0f);
    const float slack = 0.49f - radius;
    const float x = static_cast<float>(i % side) + 0.5f + random.uniform(-slack, slack) - half;
    const float z = static_cast<float>(i / side) + 0.5f + random.uniform(-slack, slack) - half;
    const MaterialId material(1 + random.below(static_cast<std::uint32_t>(scene.materials.size() - 1)));
    const Vec3 centre = turned({x, radius, z}, seconds * speeds.uniform(-1.0f, 1.0f));
    if (procedural)
      field.spheres.push_back({centre, radius, material});
    else
      add_icosphere(field, centre, radius, level, material);
  }
  scene.meshes.push_back(std::move(field));

  Mesh ground;
  ground.name = "ground";
  const float edge = 40 * half + 100;
  add_quad(ground, {-edge, 0, edge}, {edge, 0, edge}, {edge, 0, -edge}, {-edge, 0, -edge}, MaterialId(0));
  scene.meshes.push_back(std::move(ground));
  scene.instances = {{MeshId(0), {}}, {MeshId(1), {}}};

  PunctualLight sun;
  sun.kind = PunctualLight::Kind::kDirectional;
  sun.intensity = {3.2f, 2.9f, 2.4f};
  sun.direction = glm::normalize(Vec3{-0.55f, -0.8f, -0.35f});
  scene.lights.push_back(sun);
  scene.sky.radiance = {0.42f, 0.55f, 0.75f};

  // From a corner, so high that the field fills the frame whatever its size.
  const float away = std::max(half, 1.5f);
  scene.cameras.push_back(
      look_at({0.55f * away, 0.5f * away + 0.6f, 1.5f * away + 0.8f}, {0.0f, 0.1f, 0.1f * away}, 0.72f));
  scene.cameras.back().name = "corner";
  scene.cameras.push_back(look_at({0, 0.7f, half + 0.8f}, {0, 0.25f, 0}, 0.8f));
  scene.cameras.back().name = "low";
  return scene;
}

}  // namespace carousel::scene
