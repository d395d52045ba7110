#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/program/program.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// The hits of a ray that a program reports and that count.
struct ProgramHits {
  struct One {
    float t;
    Vec2 where;  ///< the normal (core/numeric/octahedral.h)
    int facing;  ///< 1: against the ray; -1: along it; 0: neither
  };
  std::array<One, kMostProgramHits> hit;
  std::size_t count = 0;
};

/// Runs the program of a primitive for a ray in its own space, and adds its work to `counts`, unless that is null. A
/// reported hit counts if it is in the ray's range, has a finite normal that is not zero, and lies in `box`: the point,
/// computed in double, may be outside by 2^-16 of the box's side and 2^-22 of the way along an axis, for the rounding
/// of t. So nothing depends on what lies around the primitive.
ProgramHits program_hits(const RayProgram& program, const Aabb& box, const Ray& ray, IntersectionCounts* counts);

}  // namespace carousel::accel
