#pragma once

#include <cstdint>
#include <vector>

#include "accel/traverse/plain_tree.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"
#include "scene/model/opacity.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The first hit of a ray by exact arithmetic: each float of ray, matrix, mesh and sphere is taken as the real number
/// it stands for, without any rounding.
struct ExactHit {
  Hit hit;               ///< t, u and v rounded once to the nearest float (of a sphere twice); a miss as every miss
  double t = kInfinity;  ///< rounded once to the nearest double
  bool tie = false;      ///< another primitive is met at exactly this t; `hit` is the first by (instance, primitive)
};

/// The exact closest hit of world-space rays, with which every level of accuracy is compared. A hit is defined by
/// geometry and by what the ray wishes: edges and vertices belong to their triangles, both sides are hit unless the ray
/// culls one, a ray in a triangle's plane passes it, a ray that touches a sphere hits it, and boxes play no role.
/// Instances, singular ones included, are R x + T with their exact vertices. A primitive that may be non-opaque is
/// asked at the exact point of its hit, unless the ray takes all for opaque.
///
/// Candidates come from trees of its own (accel/traverse/plain_tree.h), whose boxes are widened by more than double
/// arithmetic can be off. Triangles are decided in double with an error bound if that suffices
/// (accel/exact/crossing_filter.h) and by exact arithmetic otherwise (accel/exact/exact_crossing.h), spheres by exact
/// arithmetic (accel/exact/exact_sphere.h). Immutable: any thread may call.
class ExactReference {
 public:
  /// Keeps references. `any_hit` answers for the primitives that may be non-opaque; null: every surface is opaque.
  explicit ExactReference(const scene::Scene& scene, const AnyHit* any_hit = nullptr);

  /// The closest crossing with tmin <= t <= tmax at which the ray stops. `flags`: kRayCullBack, kRayCullFront,
  /// kRayForceOpaque; others change nothing. Rays that are not valid (accel/traverse/ray_check.h) miss.
  ExactHit closest(const Ray& ray, std::uint8_t flags = 0) const;

 private:
  class Search;

  const scene::Scene& scene_;
  const AnyHit* any_hit_;
  scene::Opacity opacity_;
  std::vector<PlainTree> meshes_;  // by mesh, in model space
  PlainTree instances_;            // in the world
};

/// Answers any-hit calls as they are answered at the exact point of the hit: the rounding of u and v decides nothing.
/// A level of accuracy that is traced with it differs from the reference in geometry alone.
class ExactOpacity final : public AnyHit {
 public:
  /// `asked` answers at the exact points. Keeps references.
  ExactOpacity(const scene::Scene& scene, const AnyHit& asked) : scene_(scene), asked_(asked) {}

  bool accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const override;

 private:
  const scene::Scene& scene_;
  const AnyHit& asked_;
};

}  // namespace carousel::accel
