#pragma once

#include <array>
#include <vector>

#include "accel/planes/plane_candidates.h"
#include "accel/structure/cull_plane.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// The directions of an oriented box's edges, of any length.
using BoxAxes = std::array<DVec3, 3>;

/// The axes of the box whose faces are `planes`, in the order in which OrientedBoxChoice gives them.
BoxAxes axes_of(const std::vector<CullPlane>& planes);

/// The faces of the least oriented box around what stands in a child, as cull planes in opposite pairs: a first object
/// that bounds the child beside its own box (US 20250259373, paragraphs 77 to 80). Its test is that of the planes.
class OrientedBoxChoice {
 public:
  explicit OrientedBoxChoice(const BoxedShape& child) : child_(child) {}

  void offer(const BoxAxes& axes);
  /// A box along each edge of each triangle, three points by three, and in its plane.
  void offer_triangles(const std::vector<Vec3>& points);
  /// Six planes; none if the best box has hardly less surface than the child's own.
  std::vector<CullPlane> best() const;
  /// The six planes of the box with the least surface of all that have been offered.
  std::vector<CullPlane> smallest() const { return {best_.begin(), best_.end()}; }

 private:
  const BoxedShape& child_;
  std::array<CullPlane, 6> best_{};
  double area_ = 0;  // half the surface of the best box; 0: nothing has been offered
};

}  // namespace carousel::accel
