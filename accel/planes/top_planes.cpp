#include "accel/planes/top_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "accel/planes/farthest_point.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

DVec3 size_of(const Aabb& box) {
  return glm::max(glm::abs(DVec3(box.lo)), glm::abs(DVec3(box.hi)));
}

}  // namespace

TopPlanes::TopPlanes(const Accel& accel, const scene::Scene& scene, CullPlanesConfig::Fit fit,
                     const std::vector<LanePlanes>& found)
    : accel_(accel), scene_(scene), fit_(fit), found_(found), node_margins_(accel.nodes.size()) {
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i) {
    const InstanceNode& instance = accel.instances[i];
    const bool empty = instance.triangles == 0;
    model_boxes_.push_back(empty ? Aabb{} : model_box(accel, instance.root));
    instance_margins_.push_back(empty ? std::nullopt
                                      : margin_in_world(placement(i), instance.transform, model_boxes_[i]));
  }
  for (std::size_t i = accel.nodes.size(); i-- > 0 && accel.nodes[i].above_instances;) {  // children after parents
    node_margins_[i] = margin_below();
    for (int lane = 0; lane < accel.nodes[i].count; ++lane) {
      const std::optional<LineMargin>& child = margin(accel.nodes[i].child[lane]);
      if (child && node_margins_[i])
        widen(*node_margins_[i], *child);
      else
        node_margins_[i].reset();
    }
  }
}

const std::optional<LineMargin>& TopPlanes::margin(NodeRef child) const {
  return child.is_inner() ? node_margins_[child.node()] : instance_margins_[child.instance_index()];
}

// An instance without a transform stands as it is, and so does one that has been baked.
scene::Affine TopPlanes::placement(std::uint32_t instance) const {
  return accel_.instances[instance].transform.identity ? scene::Affine{} : scene_.instances[instance].world_from_model;
}

BoxedShape TopPlanes::shape(const Node& node, int lane) const {
  const NodeRef child = node.child[lane];
  const Aabb box = child_box(node, lane);
  return {box, [this, child, box](const CullPlane& plane) {
            const DVec3 centre(plane_centre(box.lo.x, box.hi.x), plane_centre(box.lo.y, box.hi.y),
                               plane_centre(box.lo.z, box.hi.z));
            const DVec3 normal = normal_of(plane);
            return rounded_up(farthest(child, normal, centre, -std::numeric_limits<double>::infinity()));
          }};
}

/// The larger of `most` and how far the farthest point of `child` stands along `normal` from `centre`, at least.
double TopPlanes::farthest(NodeRef child, const DVec3& normal, const DVec3& centre, double most) const {
  const DVec3 along = glm::abs(normal);
  if (!child.is_inner()) {
    const std::uint32_t i = child.instance_index();
    const scene::Affine m = placement(i);
    const DMat3 linear(m.linear);
    const DVec3 offset = DVec3(m.translation) - centre;
    // Products of floats are exact in double; all sums together err by less than this.
    const double error =
        0x1p-48 * (glm::dot(along, magnitudes(linear) * size_of(model_boxes_[i])) + glm::dot(along, glm::abs(offset)));
    const double model = farthest_along(accel_, accel_.instances[i].root, glm::transpose(linear) * normal, fit_);
    return std::max(most, model + glm::dot(normal, offset) + error);
  }
  const Node& node = accel_.nodes[child.node()];
  for (int lane = 0; lane < node.count; ++lane) {
    Aabb box = child_box(node, lane);
    const DVec3 lo = DVec3(box.lo) - centre, hi = DVec3(box.hi) - centre;
    double bound = 0x1p-48 * glm::dot(along, glm::max(glm::abs(lo), glm::abs(hi)));
    for (int axis = 0; axis < 3; ++axis) bound += normal[axis] * (normal[axis] < 0 ? lo[axis] : hi[axis]);
    if (!(bound > most)) continue;
    most = fit_ == CullPlanesConfig::Fit::kBoxes ? bound : farthest(node.child[lane], normal, centre, most);
  }
  return most;
}

BoxAxes TopPlanes::axes(NodeRef child) const {
  const DMat3 linear(placement(child.instance_index()).linear);
  const DVec3 up = glm::cross(linear[0], linear[1]);
  return {linear[0], glm::cross(up, linear[0]), up};
}

// Candidates for an instance that stands rotated in its box: the faces of its own box, planes through an edge of it and
// along an axis, planes that cut off its corners, and the planes and triangles at its root. Normals are transformed by
// the transpose of the inverse.
void TopPlanes::offer(NodeRef child, PlaneChoice& choice) const {
  const std::uint32_t instance = child.instance_index();
  const DMat3 linear(placement(instance).linear), normals = glm::transpose(glm::inverse(linear));
  const DVec3 extent(model_boxes_[instance].hi - model_boxes_[instance].lo);
  for (int edge = 0; edge < 3; ++edge) {
    choice.offer_both(normals[edge]);
    for (const DVec3& axis : {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)})
      choice.offer_both(glm::cross(linear[edge], axis));
  }
  for (int signs = 0; signs < 4 && extent.x > 0 && extent.y > 0 && extent.z > 0; ++signs)
    choice.offer_both(normals * DVec3(1 / extent.x, (signs & 1 ? -1 : 1) / extent.y, (signs & 2 ? -1 : 1) / extent.z));
  const NodeRef root = accel_.instances[instance].root;
  if (root.is_inner()) {
    for (const std::vector<CullPlane>& planes : found_[root.node()])
      for (const CullPlane& plane : planes) choice.offer(normals * normal_of(plane));
    return;
  }
  for (std::uint32_t i = 0; i < root.triangles() && !root.is_procedural(); ++i) {
    const auto& v = accel_.blocks[root.first_block() + i / kBlockTriangles].vertex;
    const auto corner = [&](int k) {
      return DVec3(v[k][0][i % kBlockTriangles], v[k][1][i % kBlockTriangles], v[k][2][i % kBlockTriangles]);
    };
    choice.offer_both(normals * glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }
}

}  // namespace carousel::accel
