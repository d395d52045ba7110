#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/numeric/exponential.h"
#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

constexpr float kLeastAspect = 10, kMostAspect = 1e5f;

}  // namespace

Scene make_sliver(std::int64_t triangles, std::int64_t seed) {
  Scene scene;
  scene.name = "sliver";
  const MaterialId ground_material = add_material(scene, "ground", {0.33f, 0.33f, 0.36f}, 0, 0.9f);
  const MaterialId needles[] = {add_material(scene, "amber", {0.85f, 0.42f, 0.06f}, 0, 0.6f),
                                add_material(scene, "rose", {0.78f, 0.10f, 0.20f}, 0, 0.6f),
                                add_material(scene, "brass", {0.95f, 0.78f, 0.45f}, 1, 0.3f),
                                add_material(scene, "violet", {0.26f, 0.10f, 0.55f}, 0, 0.6f)};
  for (Material& m : scene.materials) m.double_sided = true;

  // Flat shading: the needles have no normals of their own.
  Mesh burst;
  burst.name = "needles";
  HashRandom random(static_cast<std::uint64_t>(seed), 3);
  const Vec3 centre{0, 1.3f, 0};
  for (std::int64_t k = 0; k < triangles; ++k) {
    const float y = random.uniform(-0.75f, 1), turn = random.uniform(0, 2 * std::numbers::pi_v<float>);
    const float ring = std::sqrt(std::max(0.0f, 1 - y * y));
    const Vec3 out{ring * cos_float(turn), y, ring * sin_float(turn)};
    const Vec3 any = std::abs(out.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    const Vec3 side = glm::normalize(glm::cross(out, any));
    const Vec3 other = glm::cross(out, side);
    const float roll = random.uniform(0, std::numbers::pi_v<float>);
    const Vec3 across = cos_float(roll) * side + sin_float(roll) * other;
    // Even in the logarithm, so that each power of ten gets its share.
    const float aspect = kLeastAspect * pow_float(kMostAspect / kLeastAspect, random.uniform());
    const float inner = random.uniform(0.15f, 0.4f), outer = random.uniform(0.7f, 1.25f);
    const Vec3 half_width = across * (0.5f * (outer - inner) / aspect);
    const auto first = static_cast<std::uint32_t>(burst.positions.size());
    burst.positions.push_back(centre + inner * out - half_width);
    burst.positions.push_back(centre + inner * out + half_width);
    burst.positions.push_back(centre + outer * out);
    burst.indices.insert(burst.indices.end(), {first, first + 1, first + 2});
    burst.triangle_materials.push_back(needles[random.below(4)]);
  }
  scene.meshes.push_back(std::move(burst));

  Mesh ground;
  ground.name = "ground";
  add_quad(ground, {-200, 0, 200}, {200, 0, 200}, {200, 0, -200}, {-200, 0, -200}, ground_material);
  scene.meshes.push_back(std::move(ground));
  scene.instances = {{MeshId(0), {}}, {MeshId(1), {}}};

  PunctualLight sun;
  sun.kind = PunctualLight::Kind::kDirectional;
  sun.intensity = {3.2f, 3.0f, 2.7f};
  sun.direction = glm::normalize(Vec3{-0.5f, -1.0f, -0.35f});
  scene.lights.push_back(sun);
  scene.sky.radiance = {0.40f, 0.50f, 0.68f};

  scene.cameras.push_back(look_at({1.6f, 1.9f, 3.6f}, {0, 1.15f, 0}, 0.75f));
  scene.cameras.back().name = "front";
  return scene;
}

}  // namespace carousel::scene
