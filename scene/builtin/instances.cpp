#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/builtin/nested_groups.h"
#include "scene/builtin/random_rotation.h"
#include "scene/builtin/turned.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

/// Meshes 0 to 6, all of about unit size around the origin.
void add_shapes(Scene& scene) {
  const auto add = [&](const char* name, auto&& fill) {
    Mesh mesh;
    mesh.name = name;
    fill(mesh);
    scene.meshes.push_back(std::move(mesh));
  };
  const MaterialId gold = add_material(scene, "gold", {1.0f, 0.77f, 0.34f}, 1, 0.2f);
  const MaterialId coral = add_material(scene, "coral", {0.85f, 0.17f, 0.11f}, 0, 0.6f);
  const MaterialId teal = add_material(scene, "teal", {0.03f, 0.40f, 0.42f}, 0, 0.5f);
  const MaterialId cream = add_material(scene, "cream", {0.86f, 0.80f, 0.66f}, 0, 0.9f);
  const MaterialId navy = add_material(scene, "navy", {0.04f, 0.09f, 0.32f}, 0, 0.3f);
  const MaterialId silver = add_material(scene, "silver", {0.95f, 0.94f, 0.92f}, 1, 0.08f);
  add("torus", [&](Mesh& m) { add_torus(m, 0.36f, 0.14f, 32, 16, gold); });
  add("coral ball", [&](Mesh& m) { add_icosphere(m, {0, 0, 0}, 0.5f, 3, coral); });
  add("teal box", [&](Mesh& m) { add_box(m, Vec3{-0.4f}, Vec3{0.4f}, teal); });
  add("cream cone", [&](Mesh& m) { add_cone(m, 0.45f, 1.0f, 32, cream); });
  add("navy box", [&](Mesh& m) { add_box(m, {-0.5f, -0.3f, -0.2f}, {0.5f, 0.3f, 0.2f}, navy); });
  add("silver ball", [&](Mesh& m) { add_icosphere(m, {0, 0, 0}, 0.5f, 3, silver); });
  add("half", [&](Mesh& m) {  // asymmetric, so that mirroring shows
    add_box(m, {-0.5f, -0.5f, -0.15f}, {-0.2f, 0.5f, 0.15f}, coral);
    add_box(m, {-0.2f, -0.5f, -0.15f}, {0.5f, -0.2f, 0.15f}, cream);
  });
}

/// Places the shapes one by one and returns the radius of the disc that they lie on.
float scatter(Scene& scene, std::int64_t instances, std::int64_t seed, std::uint32_t shapes) {
  // A sunflower: point k at angle k * golden angle and radius sqrt(k) keeps an even density (Vogel 1979).
  const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
  const float disc = std::sqrt(static_cast<float>(instances)) * 0.62f;
  HashRandom random(static_cast<std::uint64_t>(seed), 2);
  scene.instances.reserve(static_cast<std::size_t>(instances) + 1);
  for (std::int64_t k = 0; k < instances; ++k) {
    const float radius = 0.62f * std::sqrt(static_cast<float>(k) + 0.5f);
    const float angle = std::fmod(static_cast<float>(k) * golden, 2 * std::numbers::pi_v<float>);
    const float wave = 0.5f + 0.5f * cos_float(9 * radius / std::max(disc, 1.0f));
    Instance instance;
    instance.mesh = MeshId(random.below(shapes));
    const Mat3 rotation = random_rotation(random);
    Vec3 scale{random.uniform(0.45f, 1.0f), random.uniform(0.45f, 1.0f), random.uniform(0.45f, 1.0f)};
    if (k % 4 == 3) scale.x = -scale.x;
    instance.world_from_model.linear = rotation * Mat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z);
    instance.world_from_model.translation = {radius * cos_float(angle), 0.75f + 1.6f * wave, radius * sin_float(angle)};
    scene.instances.push_back(instance);
  }
  return disc;
}

/// Takes all instances round the middle, so that inner ones overtake outer ones.
void go_round(Scene& scene, float seconds) {
  if (seconds == 0) return;
  for (Instance& instance : scene.instances) {
    Affine& at = instance.world_from_model;
    const float radius = std::sqrt(at.translation.x * at.translation.x + at.translation.z * at.translation.z);
    const float angle = 2 * seconds / (1 + 0.5f * radius);
    at.translation = turned(at.translation, angle);
    for (int column = 0; column < 3; ++column) at.linear[column] = turned(at.linear[column], 2 * angle);
  }
}

}  // namespace

Scene make_instances(std::int64_t instances, std::int64_t seed, std::int64_t levels, float seconds) {
  Scene scene;
  scene.name = "instances";
  add_shapes(scene);
  const auto shapes = static_cast<std::uint32_t>(scene.meshes.size());
  const MaterialId ground_material = add_material(scene, "ground", {0.30f, 0.31f, 0.33f}, 0, 0.95f);

  const float disc =
      levels > 2 ? place_groups(scene, instances, seed, levels - 2, shapes) : scatter(scene, instances, seed, shapes);
  if (levels <= 2) go_round(scene, seconds);

  Mesh ground;
  ground.name = "ground";
  const float edge = 20 * disc + 100;
  add_quad(ground, {-edge, 0, edge}, {edge, 0, edge}, {edge, 0, -edge}, {-edge, 0, -edge}, ground_material);
  scene.meshes.push_back(std::move(ground));
  scene.instances.push_back({MeshId(shapes), {}});

  PunctualLight sun;
  sun.kind = PunctualLight::Kind::kDirectional;
  sun.intensity = {3.4f, 3.0f, 2.5f};
  sun.direction = glm::normalize(Vec3{-0.5f, -0.9f, -0.4f});
  scene.lights.push_back(sun);
  scene.sky.radiance = {0.45f, 0.56f, 0.72f};

  const float away = std::max(disc, 2.5f);
  scene.cameras.push_back(look_at({0.3f * away, 0.75f * away + 1, 1.55f * away}, {0, 0.8f, 0.08f * away}, 0.75f));
  scene.cameras.back().name = "near";
  scene.cameras.push_back(look_at({60 * away, 30 * away, 75 * away}, {0, 1, 0}, 0.022f));
  scene.cameras.back().name = "100 radii away";
  return scene;
}

}  // namespace carousel::scene
