#include "accel/builders/mesh/blas_meshes.h"

#include <cstdint>

#include "accel/structure/node.h"
#include "core/system/error.h"

namespace carousel::accel {

MergedMeshes merge_meshes(const scene::Scene& scene, std::vector<BlasMeshes>& sources) {
  std::vector<std::uint32_t> uses(scene.meshes.size()), standing;
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh.value];
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const scene::Affine& m = instance.world_from_model;
    const scene::Mesh& mesh = scene.meshes[instance.mesh.value];
    const bool stands = m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f);
    if (stands && uses[instance.mesh.value] == 1 && instance.placement == scene::kNoPlacement && mesh.spheres.empty() &&
        mesh.triangle_count() > 0)
      standing.push_back(i);
  }
  MergedMeshes merged;
  if (standing.size() < 2) return merged;
  for (const std::uint32_t i : standing) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
    merged.add(i, sources.empty() ? 0 : static_cast<std::uint32_t>(sources.front().triangles()));
    if (sources.empty())
      sources.emplace_back(mesh);
    else
      sources.front().add(mesh);
  }
  if (sources.front().triangles() > kPrimitiveMask)
    throw SceneError(scene.name, "", "has more triangles than a merged structure can number; try bvh.merge: none");
  return merged;
}

}  // namespace carousel::accel
