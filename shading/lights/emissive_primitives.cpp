#include "shading/lights/emissive_primitives.h"

#include <algorithm>

#include "shading/bsdf/lambert.h"
#include "shading/math/luminance.h"
#include "shading/surface/surface.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

namespace {

/// Mean luminance over a triangle: exact without a texture, otherwise from 16 evenly spread points.
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

/// The luminance of one side, as estimated from 16 points.
float sphere_flux(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive) {
  constexpr int kRows = 4;
  float sum = 0;
  for (int i = 0; i < kRows * kRows; ++i) {
    const float u = (float(i / kRows) + 0.5f) / kRows, v = (float(i % kRows) + 0.5f) / kRows;
    const auto area = static_cast<float>(triangle_geometry(scene, instance, primitive, u, v).area);
    sum += area * luminance(emitted(scene, triangle_point(scene, instance, primitive, u, v)));
  }
  return sum * (kPi / (kRows * kRows));
}

const scene::Material& material_of(const scene::Scene& scene, const scene::Mesh& mesh, std::uint32_t primitive) {
  const std::size_t triangles = mesh.triangle_count();
  const MaterialId id =
      primitive < triangles ? mesh.triangle_materials[primitive] : mesh.spheres[primitive - triangles].material;
  return scene.materials[id.value];
}

}  // namespace

EmissivePrimitives::EmissivePrimitives(const scene::Scene& scene) {
  if (std::none_of(scene.materials.begin(), scene.materials.end(), is_emissive)) return;
  rank_.resize(scene.meshes.size());
  std::vector<std::vector<std::uint32_t>> emissive(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    const std::size_t primitives = mesh.triangle_count() + mesh.spheres.size();
    for (std::uint32_t p = 0; p < primitives; ++p) {
      if (!is_emissive(material_of(scene, mesh, p))) continue;
      rank_[m].resize(primitives);
      rank_[m][p] = static_cast<std::uint32_t>(emissive[m].size());
      emissive[m].push_back(p);
    }
  }
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    first_.push_back(static_cast<std::uint32_t>(primitives_.size()));
    const std::uint32_t m = scene.instances[i].mesh.value;
    for (const std::uint32_t p : emissive[m]) {
      const bool sphere = p >= scene.meshes[m].triangle_count();
      const float sides = material_of(scene, scene.meshes[m], p).double_sided ? 2.0f : 1.0f;
      const auto area = sphere ? 0.0f : static_cast<float>(triangle_geometry(scene, i, p, 0, 0).area);
      const float flux = sphere ? sphere_flux(scene, i, p) : kPi * area * mean_luminance(scene, i, p);
      primitives_.push_back({i, p, area, flux * sides});
    }
  }
}

}  // namespace carousel::shading
