#include "scene/model/scene.h"

#include <glm/geometric.hpp>

namespace carousel::scene {

std::size_t Scene::unique_triangle_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangle_count();
  return count;
}

std::size_t Scene::instanced_triangle_count() const {
  std::size_t count = 0;
  for (const Instance& instance : instances) count += meshes[instance.mesh.value].triangle_count();
  return count;
}

Aabb Scene::bounds() const {
  Aabb all;
  for (const Instance& instance : instances) all.extend(bounds(instance));
  return all;
}

Aabb Scene::bounds(const Instance& instance) const {
  Aabb box;
  const Affine& m = instance.world_from_model;
  const Mesh& mesh = meshes[instance.mesh.value];
  for (const Vec3& p : mesh.positions) box.extend(m.linear * p + m.translation);
  for (const Sphere& sphere : mesh.spheres) {
    const Vec3 center = m.linear * sphere.center + m.translation;
    // An ellipsoid reaches as far along an axis as that row of the map is long.
    const Mat3 rows = glm::transpose(m.linear);
    const Vec3 reach = sphere.radius * Vec3(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
    box.extend(center - reach);
    box.extend(center + reach);
  }
  return box;
}

}  // namespace carousel::scene
