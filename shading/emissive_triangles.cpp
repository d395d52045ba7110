#include "shading/emissive_triangles.h"

#include <algorithm>

#include "shading/lambert.h"
#include "shading/luminance.h"
#include "shading/surface.h"
#include "shading/triangle_geometry.h"

namespace carousel::shading {

namespace {

/// Mean luminance over a triangle: exact without a texture, else from 16 evenly spread points.
float mean_luminance(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive) {
  const TrianglePoint centre = triangle_point(scene, instance, primitive, 1.0f / 3, 1.0f / 3);
  if (!centre.material->emissive_texture) return luminance(centre.material->emissive);
  // The centres of the 16 triangles that quartering twice gives.
  constexpr int kRows = 4;
  float sum = 0;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kRows - i; ++j) {
      auto at = [&](float offset) {
        const float u = (float(i) + offset) / kRows, v = (float(j) + offset) / kRows;
        return luminance(emitted(scene, triangle_point(scene, instance, primitive, u, v)));
      };
      sum += at(1.0f / 3);
      if (j + 1 < kRows - i) sum += at(2.0f / 3);
    }
  }
  return sum / (kRows * kRows);
}

}  // namespace

EmissiveTriangles::EmissiveTriangles(const scene::Scene& scene) {
  if (std::none_of(scene.materials.begin(), scene.materials.end(), is_emissive)) return;
  rank_.resize(scene.meshes.size());
  std::vector<std::vector<std::uint32_t>> emissive(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      if (!is_emissive(scene.materials[mesh.triangle_materials[t].value])) continue;
      rank_[m].resize(mesh.triangle_count());
      rank_[m][t] = static_cast<std::uint32_t>(emissive[m].size());
      emissive[m].push_back(t);
    }
  }
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    const std::uint32_t m = scene.instances[i].mesh.value;
    for (const std::uint32_t t : emissive[m]) {
      const auto area = static_cast<float>(triangle_geometry(scene, i, t, 0, 0).area);
      const bool both = scene.materials[scene.meshes[m].triangle_materials[t].value].double_sided;
      const float flux = kPi * area * mean_luminance(scene, i, t) * (both ? 2.0f : 1.0f);
      triangles_.push_back({i, t, area, flux});
    }
  }
}

}  // namespace carousel::shading
