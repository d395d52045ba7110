#pragma once

#include <cstdint>
#include <vector>

#include "core/types/ray.h"
#include "core/types/shade_facts.h"
#include "scene/model/scene.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

/// Where materials, vertices and texels lie that programs of simulated shader workers read: one table of each, all
/// meshes or images one after another. A material has 128 bytes. A vertex has 32, its position, normal and coordinates;
/// a texel 4. Spheres have no vertices.
class ShadeTables {
 public:
  /// Keeps a reference.
  explicit ShadeTables(const scene::Scene& scene);
  /// Sets what shading the hit reads.
  void reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const;

 private:
  const scene::Scene& scene_;
  std::vector<std::uint64_t> mesh_at_, image_at_;  // bytes
};

}  // namespace carousel::shading
