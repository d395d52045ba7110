#pragma once

#include <cstdint>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Alphas that differ by less count as equal: interpolation between vertices and filtering of texels round by less.
inline constexpr float kAlphaTolerance = 0x1p-20f;

/// Tells which triangles may be non-opaque and so need the any-hit call (core/types/any_hit.h). An alpha-masked surface
/// whose alpha is nowhere below its cutoff, and an alpha-blended one whose alpha is 1 everywhere, are opaque.
class Opacity {
 public:
  /// Looks through the images that such materials read for their least alpha. Keeps a reference to `scene`.
  explicit Opacity(const Scene& scene);

  /// True if some material may be non-opaque, so that an AnyHit has to be present.
  bool any() const { return any_; }
  /// Precondition: triangle < mesh.triangle_count(). Any thread.
  bool may_be_non_opaque(const Mesh& mesh, std::uint32_t triangle) const;
  bool may_be_non_opaque(const Sphere& sphere) const;

 private:
  const Scene& scene_;
  std::vector<float> least_;  // by material: factor times the least alpha of its texture; 1 for opaque ones
  bool any_ = false;
};

}  // namespace carousel::scene
