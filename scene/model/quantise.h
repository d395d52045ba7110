#pragma once

#include "scene/model/scene.h"

namespace carousel::scene {

/// Moves the vertices of each mesh to the nearest points of a grid (`scene.quantise`). Its steps are a power of two,
/// at most 2^bits of them along the longest side of the mesh's box, and fewer where floats could not hold all points
/// between the origin and the box: then 2^24 steps reach from the origin to its farthest side. So the new positions are
/// exact. Normals, spheres, and meshes that are a single point stay. `bits` is 1 to 24.
void quantise(Scene& scene, int bits);

}  // namespace carousel::scene
