#pragma once

#include <array>

#include "core/types/ray.h"

namespace carousel::accel {

/// Where a ray's line crosses a triangle, each number the float nearest to the exact one (ties to even), a zero
/// always +0; t is infinite when no float is near.
struct NearestCrossing {
  float t;
  float u, v;  ///< weights of the second and third corner
};

/// Decides by exact arithmetic on the very floats it is given whether the line of `ray` (both ways, its range
/// ignored) crosses the triangle `p`. Edges and corners belong to it. Not crossed: a triangle without area, one
/// whose plane holds the ray, a direction of zero, and anything with a NaN or an infinity.
/// Whether t lies in the ray's range is a question for the rounded t, as at the other levels: rounding is
/// monotone, so nothing that exactly lies in a range of floats is lost.
/// Ten to a hundred times slower where the ray meets an edge exactly than where it does not.
bool exact_triangle(const Ray& ray, const std::array<Vec3, 3>& p, NearestCrossing& out);

/// Whether the triangle shows a ray of that direction its front, where its corners run counter-clockwise (1), or its
/// back (-1), whatever it crosses; 0 for a triangle seen edge-on or without area, and for anything not finite. Exact.
int exact_facing(const Vec3& direction, const std::array<Vec3, 3>& p);

}  // namespace carousel::accel
