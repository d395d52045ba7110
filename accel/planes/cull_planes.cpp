#include "accel/planes/cull_planes.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "accel/planes/oriented_box.h"
#include "accel/planes/plane_candidates.h"
#include "accel/planes/second_sphere.h"
#include "accel/planes/top_planes.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

class PlaneBuilder {
 public:
  PlaneBuilder(Accel& accel, const scene::Scene& scene, const CullPlanesConfig& config, Executor& executor)
      : accel_(accel),
        scene_(scene),
        config_(config),
        executor_(executor),
        most_(config.shared_normals ? kMaxCullPlanes : static_cast<int>(config.count)),
        found_(accel.nodes.size()) {}

  void run() {
    using Levels = CullPlanesConfig::Levels;
    const auto first_of_top =
        std::find_if(accel_.nodes.begin(), accel_.nodes.end(), [](const Node& n) { return n.above_instances; });
    set_depths();
    const std::size_t below = static_cast<std::size_t>(first_of_top - accel_.nodes.begin());
    if (spheres()) {
      each(0, below, [&](std::size_t i) { sphere_lanes(i); });
      return store();
    }
    if (config_.levels != Levels::kTlas) find(0, below);
    if (config_.levels != Levels::kBlas) {
      top_.emplace(accel_, scene_, config_.fit, found_);
      find(below, found_.size());
    }
    store();
  }

 private:
  /// Planes of the nodes from `begin` to `end`, children after their parents.
  void find(std::size_t begin, std::size_t end) {
    each(begin, end, [&](std::size_t i) { leaf_lanes(i); });
    if (config_.nodes != CullPlanesConfig::Nodes::kLeaves)
      for (std::size_t i = end; i-- > begin;) inner_lanes(i);
    if (config_.shared_normals) each(begin, end, [&](std::size_t i) { share_normals(i); });
  }
  template <class Visit>
  void each(std::size_t begin, std::size_t end, const Visit& visit) {
    executor_.parallel_for(end - begin, 256, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) visit(begin + i);
    });
  }

  /// The points that planes are fitted to.
  struct Corners {
    std::vector<Vec3> points;  // corners of triangles, three by three, or of boxes
    std::vector<BlockSphere> spheres;

    float distance_along(const CullPlane& plane, const Aabb& box) const {
      float most = accel::distance_along(plane, box, points);
      for (const BlockSphere& sphere : spheres)
        most = std::max(most, accel::distance_along(plane, box, sphere.centre, sphere.radius));
      return most;
    }
  };

  // The triangles themselves, planes through their edges, and corners.
  void leaf_lanes(std::size_t index) {
    const Node& node = accel_.nodes[index];
    for (int lane = 0; lane < node.count; ++lane) {
      const NodeRef ref = node.child[lane];
      if (ref.is_inner()) continue;
      const BoxedShape child = below(node, lane);
      std::vector<CullPlane>& found = found_[index][static_cast<std::size_t>(lane)];
      if (oriented_boxes()) {
        found = oriented_leaf(ref, child);
        continue;
      }
      PlaneChoice choice(child);
      if (ref.kind() == NodeRef::Kind::kInstance) {
        top_->offer(ref, choice);
      } else {
        Corners corners;
        append_corners(ref, corners);
        offer_triangles(corners.points, choice);
      }
      choice.offer_octants();
      found = choice.best(most_);
    }
  }
  std::vector<CullPlane> oriented_leaf(NodeRef ref, const BoxedShape& child) const {
    OrientedBoxChoice choice(child);
    if (ref.kind() == NodeRef::Kind::kInstance) {
      choice.offer(top_->axes(ref));
    } else {
      Corners corners;
      append_corners(ref, corners);
      choice.offer_triangles(corners.points);
    }
    return choice.best();
  }
  bool spheres() const { return config_.object == CullPlanesConfig::Object::kSphere; }
  bool oriented_boxes() const { return config_.object == CullPlanesConfig::Object::kOrientedBox; }
  static void offer_triangles(const std::vector<Vec3>& points, PlaneChoice& choice) {
    for (std::size_t i = 0; i < points.size(); i += 3) {
      const std::array<DVec3, 3> p{DVec3(points[i]), DVec3(points[i + 1]), DVec3(points[i + 2])};
      choice.offer_both(glm::cross(p[1] - p[0], p[2] - p[0]));
      for (std::size_t k = 0; k < 3; ++k)
        for (const DVec3& axis : {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)})
          choice.offer_both(glm::cross(p[(k + 1) % 3] - p[k], axis));
    }
  }

  // The children's own planes, moved out until everything below is behind them.
  void inner_lanes(std::size_t index) {
    const Node& node = accel_.nodes[index];
    for (int lane = 0; lane < node.count; ++lane) {
      if (!node.child[lane].is_inner()) continue;
      const BoxedShape child = below(node, lane);
      if (oriented_boxes()) {
        OrientedBoxChoice choice(child);
        for (const std::vector<CullPlane>& planes : found_[node.child[lane].node()])
          if (!planes.empty()) choice.offer(axes_of(planes));
        found_[index][static_cast<std::size_t>(lane)] = choice.best();
        continue;
      }
      PlaneChoice choice(child);
      for (const std::vector<CullPlane>& planes : found_[node.child[lane].node()])
        for (const CullPlane& plane : planes) choice.offer(normal_of(plane));
      choice.offer_octants();
      found_[index][static_cast<std::size_t>(lane)] = choice.best(most_);
    }
  }

  void sphere_lanes(std::size_t index) {
    const Node& node = accel_.nodes[index];
    for (int lane = 0; lane < node.count; ++lane) {
      if (!wanted(node, lane)) continue;
      const Corners corners = corners_below(node.child[lane]);
      if (const auto sphere = second_sphere(corners.points, corners.spheres, child_box(node, lane)))
        found_[index][static_cast<std::size_t>(lane)] = {*sphere};
    }
  }

  Corners corners_below(NodeRef child) const {
    Corners corners;
    if (child.is_inner() && config_.fit == CullPlanesConfig::Fit::kBoxes)
      append_box_corners(accel_.nodes[child.node()], corners.points);
    else
      append_corners(child, corners);
    return corners;
  }

  /// The points that a lane's planes are fitted to.
  BoxedShape below(const Node& node, int lane) const {
    if (node.above_instances) return top_->shape(node, lane);
    const Aabb box = child_box(node, lane);
    Corners corners = corners_below(node.child[lane]);
    return {box, [box, all = std::move(corners)](const CullPlane& plane) { return all.distance_along(plane, box); }};
  }

  // The lanes' own choices are the candidates.
  void share_normals(std::size_t index) {
    const Node& node = accel_.nodes[index];
    std::vector<BoxedShape> siblings;
    std::vector<std::size_t> lanes;
    std::vector<CullPlane> candidates;
    for (int lane = 0; lane < node.count; ++lane) {
      if (!wanted(node, lane)) continue;
      siblings.push_back(below(node, lane));
      lanes.push_back(static_cast<std::size_t>(lane));
      const std::vector<CullPlane>& own = found_[index][lanes.back()];
      candidates.insert(candidates.end(), own.begin(), own.end());
    }
    std::vector<std::vector<CullPlane>> planes = shared_planes(siblings, candidates, static_cast<int>(config_.count));
    for (std::size_t i = 0; i < lanes.size(); ++i) found_[index][lanes[i]] = std::move(planes[i]);
  }

  /// Appends the corners of all primitives below `ref`.
  void append_corners(NodeRef ref, Corners& out) const {
    if (ref.is_inner()) {
      const Node& node = accel_.nodes[ref.node()];
      for (int lane = 0; lane < node.count; ++lane) append_corners(node.child[lane], out);
      return;
    }
    for (std::uint32_t i = 0; i < ref.triangles(); ++i) {
      const TriangleBlock& block = accel_.blocks[ref.first_block() + i / kBlockTriangles];
      if (ref.is_procedural()) {
        out.spheres.push_back(sphere_in(block, i % kBlockTriangles));
        continue;
      }
      for (const auto& vertex : block.vertex)
        out.points.push_back(
            {vertex[0][i % kBlockTriangles], vertex[1][i % kBlockTriangles], vertex[2][i % kBlockTriangles]});
    }
  }
  static void append_box_corners(const Node& node, std::vector<Vec3>& out) {
    for (int lane = 0; lane < node.count; ++lane) {
      const Aabb box = child_box(node, lane);
      for (int corner = 0; corner < 8; ++corner)
        out.push_back(
            {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y, corner & 4 ? box.hi.z : box.lo.z});
    }
  }

  bool wanted(const Node& node, int lane) const {
    using Nodes = CullPlanesConfig::Nodes;
    const NodeRef child = node.child[lane];
    if (node.direct >> lane & 1) return false;
    if (node.depth < config_.depth.first || node.depth > config_.depth.last) return false;
    if (node.above_instances && !(top_ && top_->margin(child))) return false;
    return config_.nodes == Nodes::kAll || child.is_inner() == (config_.nodes == Nodes::kInner);
  }

  void set_margin(Node& node) const {
    LineMargin most = margin_below();
    for (int lane = 0; lane < node.count && node.above_instances; ++lane)
      if (wanted(node, lane)) widen(most, *top_->margin(node.child[lane]));
    node.margin_per_reach = most.per_reach;
    node.least_margin = most.least;
  }

  void store() {
    for (std::size_t i = 0; i < found_.size(); ++i) {
      Node& node = accel_.nodes[i];
      node.first_plane = static_cast<std::uint32_t>(accel_.planes.size());
      for (int lane = 0; lane < node.count; ++lane) {
        const std::vector<CullPlane>& planes = found_[i][static_cast<std::size_t>(lane)];
        if (!wanted(node, lane)) continue;
        accel_.planes.insert(accel_.planes.end(), planes.begin(), planes.end());
        node.plane_counts |= static_cast<std::uint32_t>(planes.size()) << (4 * lane);
      }
      set_margin(node);
    }
    accel_.planes.shrink_to_fit();
    accel_.shared_normals = config_.shared_normals;
    accel_.second_spheres = spheres();
    accel_.planes_first = config_.order == CullPlanesConfig::Order::kPlanesFirst;
    for (const Node& node : accel_.nodes) accel_.plane_bytes += plane_bytes(node, accel_.shared_normals);
  }

  /// Children come after their parents.
  void set_depths() {
    for (const Node& node : accel_.nodes)
      for (int lane = 0; lane < node.count; ++lane)
        if (node.child[lane].is_inner())
          if (Node& child = accel_.nodes[node.child[lane].node()]; child.above_instances == node.above_instances)
            child.depth = static_cast<std::uint8_t>(std::min(node.depth + 1, 255));
  }

  Accel& accel_;
  const scene::Scene& scene_;
  const CullPlanesConfig& config_;
  Executor& executor_;
  int most_;                       // planes a lane to begin with
  std::vector<LanePlanes> found_;  // by node and lane
  std::optional<TopPlanes> top_;   // where the top level gets any
};

}  // namespace

void add_cull_planes(Accel& accel, const scene::Scene& scene, const CullPlanesConfig& config, Executor& executor) {
  if (config.count > 0) PlaneBuilder(accel, scene, config, executor).run();
}

Accel plain_copy(const Accel& accel) {
  Accel plain = accel;
  for (Node& node : plain.nodes) {
    node.plane_counts = 0;
    node.direct = 0;
  }
  plain.planes.clear();
  plain.plane_bytes = 0;
  plain.elements = {};
  return plain;
}

bool is_plain(const Accel& accel) {
  return accel.planes.empty() && accel.elements.empty() &&
         std::none_of(accel.nodes.begin(), accel.nodes.end(), [](const Node& node) { return node.direct != 0; });
}

}  // namespace carousel::accel
