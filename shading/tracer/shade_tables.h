#pragma once

#include <cstdint>
#include <vector>

#include "core/types/ray.h"
#include "core/types/shade_facts.h"
#include "scene/model/scene.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

/// Where materials, vertices and texels lie that simulated shader workers read: one table of each, all
/// meshes or images one after another. A material has 128 bytes. A vertex has 32, its position, normal and coordinates;
/// a texel 4. Spheres have no vertices.
class ShadeTables {
 public:
  /// Keeps a reference.
  explicit ShadeTables(const scene::Scene& scene);
  /// Sets what shading the hit reads.
  void reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const;
  /// The same of an any-hit call.
  void opacity_reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const;

  /// Where a vertex of a mesh stands among all vertices.
  DataRead vertex(std::uint32_t mesh, std::uint32_t vertex) const;

 private:
  void geometry_reads(const Hit& hit, const TrianglePoint& point, ShadeFacts& facts) const;
  void lookup(const TrianglePoint& point, const scene::TextureUse& use, ShadeFacts& facts) const;

  const scene::Scene& scene_;
  std::vector<std::uint64_t> mesh_at_, image_at_;  // bytes
};

}  // namespace carousel::shading
