#pragma once

#include "core/config/fields/accuracy.h"
#include "core/types/vec.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

/// The side of a triangle to which a ray leaves.
enum class Side { kFront, kBack };

/// The origin of a ray that must not meet the triangle it leaves: `accuracy.spawn`, an accuracy key. `epsilon` goes
/// 1e-4 scene units along the normal, for a scene of any size; `ulp` 256 steps of each coordinate's last bit times the
/// normal (Ray Tracing Gems 2019, chapter 6). With `bound` the point is strictly on its side of the triangle's plane,
/// by more than the rounding errors of the tracer's transforms to and from the instance's space, in two steps, and of
/// its intersection kernel.
Vec3 spawn_point(const TriangleGeometry& geometry, Side side, SpawnOffset offset);

/// Distance along the normal by which `bound` moves the point, before rounding outwards.
double spawn_distance(const TriangleGeometry& geometry);

}  // namespace carousel::shading
