#pragma once

#include <array>
#include <optional>
#include <vector>

#include "accel/planes/line_margin.h"
#include "accel/planes/oriented_box.h"
#include "accel/planes/plane_candidates.h"
#include "accel/structure/accel.h"
#include "core/config/fields/cull_planes.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Planes of a node's children.
using LanePlanes = std::array<std::vector<CullPlane>, kMaxWidth>;

/// The instances in the world, from which cull planes above them are made.
class TopPlanes {
 public:
  /// Keeps references. `found` has the planes of nodes below the instances, if there are any, by node.
  TopPlanes(const Accel& accel, const scene::Scene& scene, CullPlanesConfig::Fit fit,
            const std::vector<LanePlanes>& found);

  /// The contents of a child of a node of the top level.
  BoxedShape shape(const Node& node, int lane) const;
  /// The axes of an instance's own box in the world, made upright where the instance is sheared.
  BoxAxes axes(NodeRef instance) const;
  /// Offers normals of planes for an instance.
  void offer(NodeRef instance, PlaneChoice& choice) const;
  /// Bound of a hit's distance from the ray's line in the child; empty: the bound is too large for planes to be useful.
  const std::optional<LineMargin>& margin(NodeRef child) const;

 private:
  scene::Affine placement(std::uint32_t instance) const;
  double farthest(NodeRef child, const DVec3& normal, const DVec3& centre, double most) const;

  const Accel& accel_;
  const scene::Scene& scene_;
  CullPlanesConfig::Fit fit_;
  const std::vector<LanePlanes>& found_;
  std::vector<std::optional<LineMargin>> instance_margins_, node_margins_;  // for the top level; the latter by node
  std::vector<Aabb> model_boxes_;                                           // by instance
};

}  // namespace carousel::accel
