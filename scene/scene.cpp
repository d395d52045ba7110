#include "scene/scene.h"

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
  for (const Instance& instance : instances) {
    const Affine& m = instance.world_from_model;
    for (const Vec3& p : meshes[instance.mesh.value].positions) all.extend(m.linear * p + m.translation);
  }
  return all;
}

}  // namespace carousel::scene
