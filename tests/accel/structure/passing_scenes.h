#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

#include "core/types/any_hit.h"
#include "scene/builtin/hash_random.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {

/// Stops rays by a hash of everything it is told, or never, and counts how often it was asked.
class HashedStop final : public AnyHit {
 public:
  explicit HashedStop(double probability) : below_(static_cast<std::uint64_t>(probability * 0x1p32)) {}
  bool accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const override {
    any_hit_calls_.fetch_add(1, std::memory_order_relaxed);
    std::uint64_t hash = 0x9e3779b97f4a7c15u;
    const auto mix = [&](std::uint32_t bits) {
      hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
      hash ^= hash >> 33;
    };
    for (int axis = 0; axis < 3; ++axis) {
      mix(std::bit_cast<std::uint32_t>(ray.origin[axis]));
      mix(std::bit_cast<std::uint32_t>(ray.direction[axis]));
    }
    mix(instance), mix(primitive), mix(std::bit_cast<std::uint32_t>(u)), mix(std::bit_cast<std::uint32_t>(v));
    return hash >> 32 < below_;
  }
  std::uint64_t any_hit_calls() const { return any_hit_calls_; }

 private:
  std::uint64_t below_;
  mutable std::atomic<std::uint64_t> any_hit_calls_{0};
};

/// A built-in scene half of whose triangles may let rays through, with `balls` spheres, likewise, in two meshes: one of
/// spheres alone that is placed twice, stretched and mirrored, and one that holds triangles as well.
inline scene::Scene passing_scene(BuiltinScene builtin, std::uint32_t balls, std::uint64_t seed,
                                  std::int64_t levels = 2) {
  Random random(seed);
  scene::Scene scene = small_builtin(builtin, 250, levels > 2 ? 20 : 6, levels);
  const MaterialId blended(static_cast<std::uint32_t>(scene.materials.size()));
  scene.materials.emplace_back().alpha_mode = scene::AlphaMode::kBlend;
  scene.materials.back().base_color.a = 0.5f;
  for (scene::Mesh& mesh : scene.meshes)
    for (MaterialId& material : mesh.triangle_materials)
      if (random.below(2) == 0) material = blended;
  if (balls == 0) return scene;
  const Aabb bounds = scene.bounds();
  const float size = 0.2f * std::max({bounds.extent().x, bounds.extent().y, bounds.extent().z});
  scene::Mesh spheres;
  for (std::uint32_t i = 0; i < balls; ++i)
    spheres.spheres.push_back({random.in_box(bounds.lo, bounds.hi), size * random.uniform(0.05f, 1),
                               random.below(2) == 0 ? blended : MaterialId(0)});
  scene::Mesh both = scene.meshes.front();
  both.spheres = spheres.spheres;
  const auto add = [&](scene::Mesh mesh, const scene::Affine& placement) {
    scene.meshes.push_back(std::move(mesh));
    add_instance(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1), placement);
  };
  add(spheres, {});
  add_instance(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1),
               {Mat3(Vec3{-1, 0.2f, 0}, Vec3{0, 0.7f, 0.1f}, Vec3{0.3f, 0, 1.3f}), 0.3f * bounds.extent()});
  add(both, {Mat3(0.8f), -0.2f * bounds.extent()});
  return scene;
}

/// The mix of rays with all wishes among them.
inline RayBatch wishing_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed) {
  RayBatch rays = mixed_rays(scene, count, seed);
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays[i].tag.flags = static_cast<std::uint8_t>((i * 2654435761u >> 20) & kRequestFlags);
  return rays;
}

}  // namespace carousel::accel
