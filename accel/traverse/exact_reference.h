#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The first hit of a ray by exact arithmetic: each float of ray, matrix and mesh is taken as the real number it stands
/// for, without any rounding.
struct ExactHit {
  Hit hit;               ///< t, u and v rounded once to the nearest float; a miss as every miss
  double t = kInfinity;  ///< rounded once to the nearest double
  bool tie = false;      ///< another triangle is met at exactly this t; `hit` is the first by (instance, primitive)
};

/// The exact closest hit of world-space rays, with which every level of accuracy is compared. A hit is defined by
/// geometry alone: edges and vertices belong to their triangles, both sides are hit, a ray in a triangle's plane passes
/// it, every material is opaque, procedural primitives are absent, and boxes play no role. Instances, singular ones
/// included, are R x + T with their exact vertices.
///
/// Candidates come from the nodes of a built structure, whose boxes are widened by more than double arithmetic can be
/// off. Each is decided in double with an error bound if that suffices (accel/exact/crossing_filter.h) and by exact
/// arithmetic otherwise (accel/exact/exact_crossing.h). Immutable: any thread may call.
class ExactReference {
 public:
  /// Keeps references. `accel` must have been built from `scene`, at any accuracy.
  ExactReference(const scene::Scene& scene, const Accel& accel);

  /// The closest crossing with tmin <= t <= tmax. Rays that are not valid (accel/traverse/ray_check.h) miss.
  ExactHit closest(const Ray& ray) const;

 private:
  class Search;

  const scene::Scene& scene_;
  const Accel& accel_;
  std::vector<double> baked_off_;  // by instance: how far rounding moved vertices that were baked into world space
};

}  // namespace carousel::accel
