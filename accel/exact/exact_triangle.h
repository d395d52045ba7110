#pragma once

#include <array>
#include <cstdint>

#include "core/types/ray.h"

namespace carousel::accel {

/// The crossing of a ray's line with a triangle, each number the float nearest to the exact one (ties to even), a zero
/// always +0; t is infinite if it is beyond the range of float.
struct NearestCrossing {
  float t;
  float u, v;  ///< weights of the second and third corner
};

/// Decides by exact arithmetic on the very floats it is given whether the line of `ray` (both ways, its range
/// ignored) crosses the triangle `p`. Edges and corners belong to it. Not crossed: a triangle without area, one
/// whose plane holds the ray, a direction of zero, and anything with a NaN or an infinity.
/// The caller compares the rounded t with the ray's range, as at the other levels: rounding is monotone, so no crossing
/// that exactly lies in a range of floats is lost.
/// The function is ten to a hundred times slower for a ray that meets an edge exactly.
bool exact_triangle(const Ray& ray, const std::array<Vec3, 3>& p, NearestCrossing& out);

/// The volumes that exact_triangle() has computed by exact arithmetic in this thread, because doubles did not decide a
/// sign or a nearest float: the hardware's fall-back, which the caller counts by difference.
std::uint64_t exact_volumes();

/// The side that the triangle shows to rays of that direction: 1 for the front, where its corners run
/// counter-clockwise, -1 for the back; 0 for a triangle seen edge-on or without area, and for anything not finite.
/// Exact.
int exact_facing(const Vec3& direction, const std::array<Vec3, 3>& p);

}  // namespace carousel::accel
