#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/system/executor.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/model/scene.h"

namespace carousel::accel {

inline scene::Scene empty_scene() {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene.cameras.emplace_back();
  return scene;
}

inline std::uint32_t add_mesh(scene::Scene& scene, scene::Mesh mesh) {
  mesh.triangle_materials.assign(mesh.triangle_count(), MaterialId(0));
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

inline void add_instance(scene::Scene& scene, std::uint32_t mesh, const scene::Affine& placement = {}) {
  scene.instances.push_back({MeshId(mesh), placement});
}

/// Triangles that share nothing, three positions each.
inline scene::Mesh soup(const std::vector<Vec3>& corners) {
  scene::Mesh mesh;
  mesh.positions = corners;
  for (std::uint32_t i = 0; i < corners.size(); ++i) mesh.indices.push_back(i);
  return mesh;
}

inline scene::Scene scene_of(scene::Mesh mesh, const scene::Affine& placement = {}) {
  scene::Scene scene = empty_scene();
  add_instance(scene, add_mesh(scene, std::move(mesh)), placement);
  return scene;
}

inline scene::Scene icosphere_scene(int level, const Vec3& centre = Vec3{0}, float radius = 1) {
  scene::Mesh mesh;
  scene::add_icosphere(mesh, centre, radius, level, MaterialId(0));
  return scene_of(std::move(mesh));
}

/// A built-in scene of a size that brute force can stand.
inline scene::Scene small_builtin(BuiltinScene builtin, std::int64_t triangles = 300, std::int64_t instances = 12,
                                  std::int64_t levels = 2) {
  SceneConfig config;
  config.levels = levels;
  config.builtin = builtin;
  config.triangles = triangles;
  config.instances = instances;
  return scene::make_builtin(config);
}

inline Accel build_sequential(const scene::Scene& scene, std::int64_t width = 8, std::int64_t leaf = 4,
                              const AccuracyConfig& accuracy = {}) {
  BvhConfig config;
  config.width = width;
  config.leaf_triangles = leaf;
  return build(scene, config, *make_sequential_executor(), accuracy);
}

}  // namespace carousel::accel
