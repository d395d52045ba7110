#pragma once

#include <cstdint>

namespace carousel {

/// What testing rays cost, in tests: one box, triangle, procedural primitive, plane or bundle against one ray (bundle),
/// or one ray brought from world to model space.
struct IntersectionCounts {
  std::uint64_t box = 0, triangle = 0, procedural = 0, plane = 0, bundle = 0, transforms = 0;
  std::uint64_t any_hit_calls =
      0;                     ///< times that it was asked whether a primitive lets a ray through (core/types/any_hit.h)
  std::uint64_t culled = 0;  ///< children whose box was hit, which a plane showed to be missed
  std::uint64_t inversions = 0;  ///< of an instance's matrix, before rays are transformed

  IntersectionCounts& operator+=(const IntersectionCounts& o) {
    box += o.box;
    triangle += o.triangle;
    procedural += o.procedural;
    plane += o.plane;
    bundle += o.bundle;
    transforms += o.transforms;
    any_hit_calls += o.any_hit_calls;
    culled += o.culled;
    inversions += o.inversions;
    return *this;
  }
  friend bool operator==(const IntersectionCounts&, const IntersectionCounts&) = default;
};

}  // namespace carousel
