#pragma once

#include <array>

#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The answer of double arithmetic with a proven error bound about a crossing (J. R. Shewchuk, "Adaptive precision
/// floating-point arithmetic and fast robust geometric predicates", 1997, section 3: the filter before the exact
/// stage).
struct FilteredCrossing {
  enum class Verdict { kMiss, kHit, kUnsure } verdict = Verdict::kUnsure;
  double t_lo = 0, t_hi = 0;  ///< kHit: the exact t lies between, both ends included
};

/// The crossing of exact_crossing(), where doubles are sure of it.
FilteredCrossing filtered_crossing(const Ray& ray, const std::array<Vec3, 3>& model,
                                   const scene::Affine& world_from_model);

}  // namespace carousel::accel
