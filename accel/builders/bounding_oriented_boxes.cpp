#include "accel/builders/bounding_oriented_boxes.h"

#include <algorithm>
#include <array>
#include <limits>

#include <glm/geometric.hpp>

#include "accel/planes/oriented_box.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/primitive_boxes.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

/// The primitives below a child: the vertices of triangles, and the boxes of triangles and of all others.
struct Below {
  std::vector<Vec3> corners;
  std::vector<Aabb> triangles, others;

  double farthest_of_boxes(const DVec3& n, const std::vector<Aabb>& boxes) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Aabb& box : boxes) {
      double along = 0;
      for (int axis = 0; axis < 3; ++axis) along += n[axis] * (n[axis] < 0 ? box.lo[axis] : box.hi[axis]);
      most = std::max(most, along);
    }
    return most;
  }
  double farthest(const DVec3& n) const {
    double most = farthest_of_boxes(n, others);
    for (const Vec3& corner : corners) most = std::max(most, glm::dot(n, DVec3(corner)));
    return most;
  }
  double farthest_of_boxes(const DVec3& n) const {
    return std::max(farthest_of_boxes(n, others), farthest_of_boxes(n, triangles));
  }
};

void append(const Accel& accel, const Node& node, int lane, Below& out) {
  const NodeRef child = node.child[lane];
  if (child.is_instance()) {
    out.others.push_back(child_box(node, lane));
    return;
  }
  if (child.is_inner()) {
    const Node& below = accel.nodes[child.node()];
    for (int l = 0; l < below.count; ++l) append(accel, below, l, out);
    return;
  }
  for (std::uint32_t i = 0; i < child.triangles(); ++i) {
    (child.is_procedural() ? out.others : out.triangles).push_back(primitive_box(accel, child, i));
    if (child.is_procedural()) continue;
    for (const Vec3& corner : triangle_corners(accel, child, i)) out.corners.push_back(corner);
  }
}

DVec3 centre_of(const Aabb& box) {
  return {plane_centre(box.lo.x, box.hi.x), plane_centre(box.lo.y, box.hi.y), plane_centre(box.lo.z, box.hi.z)};
}

class OrientedBoxFit {
 public:
  explicit OrientedBoxFit(const Accel& accel) : accel_(accel), all_(accel.nodes.size()), axes_(accel.nodes.size()) {}

  std::vector<NodeOrientedBoxes> run(Executor& executor) {
    executor.parallel_for(all_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) fit(i, false);
    });
    for (std::size_t i = all_.size(); i-- > 0;) fit(i, true);  // children come after their parents
    return std::move(all_);
  }

 private:
  void fit(std::size_t index, bool inner) {
    const Node& node = accel_.nodes[index];
    for (int lane = 0; lane < node.count; ++lane)
      if (node.child[lane].is_inner() == inner) fit_lane(index, lane);
  }

  void fit_lane(std::size_t index, int lane) {
    const Node& node = accel_.nodes[index];
    const NodeRef child = node.child[lane];
    const Aabb box = child_box(node, lane);
    const DVec3 centre = centre_of(box);
    Below below;
    append(accel_, node, lane, below);
    // The choice needs no exact distances.
    const BoxedShape shape{box, [&](const CullPlane& plane) {
                             const DVec3 n = normal_of(plane);
                             return static_cast<float>(below.farthest(n) - glm::dot(n, centre));
                           }};
    OrientedBoxChoice choice(shape);
    if (child.is_inner()) {
      for (const std::vector<CullPlane>& planes : axes_[child.node()])
        if (!planes.empty()) choice.offer(axes_of(planes));
    } else {
      choice.offer_triangles(below.corners);
    }
    std::vector<CullPlane>& planes = axes_[index][static_cast<std::size_t>(lane)];
    planes = choice.best();
    if (planes.empty()) {
      OrientedBoxChoice along_axes(shape);
      along_axes.offer({DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)});
      planes = along_axes.smallest();
    }
    for (int k = 0; k < 3; ++k)
      store(below, normal_of(planes[2 * static_cast<std::size_t>(k)]), box, k, lane, all_[index]);
  }

  /// Products of floats are exact in double; the sums err by less than is added.
  static void store(const Below& below, const DVec3& n, const Aabb& box, int k, int lane, NodeOrientedBoxes& out) {
    const double error = 0x1p-48 * glm::dot(glm::abs(n), glm::max(glm::abs(DVec3(box.lo)), glm::abs(DVec3(box.hi))));
    for (int axis = 0; axis < 3; ++axis) out.normal[k][axis][lane] = static_cast<float>(n[axis]);
    out.hi[k][lane] = rounded_up(below.farthest(n) + error);
    out.lo[k][lane] = rounded_down(-below.farthest(-n) - error);
    out.box_hi[k][lane] = rounded_up(below.farthest_of_boxes(n) + error);
    out.box_lo[k][lane] = rounded_down(-below.farthest_of_boxes(-n) - error);
  }

  const Accel& accel_;
  std::vector<NodeOrientedBoxes> all_;
  std::vector<std::array<std::vector<CullPlane>, kMaxWidth>> axes_;  // as faces of boxes, by node and lane
};

}  // namespace

std::vector<NodeOrientedBoxes> bounding_oriented_boxes(const Accel& accel, Executor& executor) {
  return OrientedBoxFit(accel).run(executor);
}

}  // namespace carousel::accel
