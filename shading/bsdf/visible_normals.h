#pragma once

// Integrals over the microfacet normals that are visible from one direction, for integrands with too many parameters
// for a table. The points are a Fibonacci lattice (I. Sloan, S. Joe, "Lattice methods for multiple integration", 1994,
// section 5.1), closer together where facets are seen edge-on, since masking changes fastest there. With 144 points the
// albedo of any two roughnesses, cosine 0.03 to 1, differed from that of 9,216 points by 0.07 % in the mean and 0.5 %
// at most. Total reflection begins so suddenly that it needs 610.

#include <algorithm>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "core/types/vec.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

struct LatticePoint {
  float cos_azimuth, sin_azimuth;
  float below;   ///< 1 - u.y of sample_visible_normal()
  float weight;  ///< all together 1
};
/// 144 or 610 points; computed on first use, then read-only. Any thread.
std::span<const LatticePoint> coarse_lattice();
std::span<const LatticePoint> fine_lattice();

/// Calls visit(h, weight) for normals visible from `wo`, unit with wo.z > 0; the weights add up to 1.
template <class Visit>
void visit_visible_normals(std::span<const LatticePoint> lattice, const Vec3& wo, const Vec2& alpha,
                           const Visit& visit) {
  const Vec3 stretched = glm::normalize(Vec3{wo.x * alpha.x, wo.y * alpha.y, wo.z});
  for (const LatticePoint& p : lattice) {
    const float z = p.below * (1.0f + stretched.z) - stretched.z;
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const Vec3 h = Vec3{r * p.cos_azimuth, r * p.sin_azimuth, z} + stretched;
    visit(glm::normalize(Vec3{h.x * alpha.x, h.y * alpha.y, std::max(h.z, 1e-9f)}), p.weight);
  }
}

}  // namespace carousel::shading
