#pragma once

#include "core/config/config.h"
#include "core/types/vec.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

/// Which side of a triangle a ray leaves to.
enum class Side { kFront, kBack };

/// Where a ray starts so that it does not meet the triangle it leaves: `accuracy.spawn`, an accuracy key.
/// `epsilon` goes 1e-4 scene units along the normal, whatever the scene's size; `ulp` 256 steps of each coordinate's
/// last bit times the normal (Ray Tracing Gems 2019, chapter 6). With `bound` the point is strictly on its side of the
/// triangle's plane, by more than what the tracer's own transforms to and from the instance's space, in two steps,
/// and its intersection kernel can take away.
Vec3 spawn_point(const TriangleGeometry& geometry, Side side, SpawnOffset offset);

/// How far along the normal `bound` moves the point, before rounding outwards.
double spawn_distance(const TriangleGeometry& geometry);

}  // namespace carousel::shading
