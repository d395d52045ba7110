#pragma once

#include <cstdint>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Alphas this near are equal: interpolation of the vertices' and filtering of the texels' may round by less.
inline constexpr float kAlphaTolerance = 0x1p-20f;

/// Which triangles may let rays through: those of which core/types/any_hit.h has to be asked. A cut-out whose alpha is
/// nowhere below its cutoff and a veil whose alpha is 1 everywhere are solid, whatever their mode says.
class Opacity {
 public:
  /// Looks through the images that such materials read for their least alpha. Keeps a reference to `scene`.
  explicit Opacity(const Scene& scene);

  /// True if some material does, so that somebody has to be there to be asked.
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
