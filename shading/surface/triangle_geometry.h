#pragma once

#include <array>
#include <cstdint>

#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// A point of a triangle of an instance, and all that leaving it needs. Computed in double from the float
/// vertices and barycentrics: cheap beside a ray's traversal, and then slivers have a normal too.
struct TriangleGeometry {
  std::array<DVec3, 3> model;  ///< vertices in the space in which `linear` and `translation` apply
  DMat3 linear{1.0};
  DVec3 translation{0};
  std::array<double, 3> weights;  ///< barycentric
  DVec3 position;                 ///< world
  DVec3 normal;                   ///< world, unit, on the front (counter-clockwise) side
  double area = 0;                ///< world; 0 for a degenerate triangle, whose normal is then +z
  bool mirrored = false;          ///< the instance turns the winding; `normal` has that undone
  double error = 0;               ///< model space: how far a program's hit may be off along its normal
};

/// Or of a sphere (scene::Mesh::spheres), whose front is its outside; `u` and `v` are then those of
/// core/numeric/octahedral.h, and `area` is the world area to a unit of solid angle seen from its middle in model
/// space, times 4 pi: the inverse of the density of points that are spread evenly over the unit sphere. `u` weighs
/// vertex 1 and `v` vertex 2 of triangle `primitive`. An instance whose linear part is singular is traced in world
/// space (its vertices rounded to float there), so that is the geometry returned for it.
TriangleGeometry triangle_geometry(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive, float u,
                                   float v);

/// The geometry of where a ray hit. A program tells the normal alone, and the point is that of the ray.
TriangleGeometry hit_geometry(const scene::Scene& scene, const Ray& ray, const Hit& hit);

}  // namespace carousel::shading
