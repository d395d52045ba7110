#include "accel/cull_planes.h"

#include <array>

#include "accel/cull_plane_test.h"
#include "accel/plane_candidates.h"

namespace carousel::accel {

namespace {

using LanePlanes = std::array<std::vector<CullPlane>, kMaxWidth>;

class PlaneBuilder {
 public:
  PlaneBuilder(Accel& accel, const CullPlanesConfig& config, Executor& executor)
      : accel_(accel),
        config_(config),
        executor_(executor),
        most_(config.shared_normals ? kMaxCullPlanes : static_cast<int>(config.count)),
        found_(accel.nodes.size()) {}

  void run() {
    executor_.parallel_for(found_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) leaf_lanes(i);
    });
    if (config_.nodes != CullPlanesConfig::Nodes::kLeaves)
      for (std::size_t i = found_.size(); i-- > 0;) inner_lanes(i);   // children come after their parents
    if (config_.shared_normals)
      executor_.parallel_for(found_.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) share_normals(i);
      });
    store();
    set_depths();
  }

 private:
  // The triangles themselves, planes through their edges, and corners.
  void leaf_lanes(std::size_t index) {
    const Node& node = accel_.nodes[index];
    for (int lane = 0; lane < node.count; ++lane) {
      if (node.child[lane].kind() != NodeRef::Kind::kLeaf) continue;
      const BoxedPoints child = below(node, lane);
      PlaneChoice choice(child);
      for (std::size_t i = 0; i < child.points.size(); i += 3) {
        const std::array<DVec3, 3> p{DVec3(child.points[i]), DVec3(child.points[i + 1]), DVec3(child.points[i + 2])};
        choice.offer_both(glm::cross(p[1] - p[0], p[2] - p[0]));
        for (std::size_t k = 0; k < 3; ++k)
          for (const DVec3& axis : {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)})
            choice.offer_both(glm::cross(p[(k + 1) % 3] - p[k], axis));
      }
      choice.offer_octants();
      found_[index][static_cast<std::size_t>(lane)] = choice.best(most_);
    }
  }

  // The children's own planes, moved out until everything below is behind them.
  void inner_lanes(std::size_t index) {
    const Node& node = accel_.nodes[index];
    if (node.above_instances) return;
    for (int lane = 0; lane < node.count; ++lane) {
      if (!node.child[lane].is_inner()) continue;
      const BoxedPoints child = below(node, lane);
      PlaneChoice choice(child);
      for (const std::vector<CullPlane>& planes : found_[node.child[lane].node()])
        for (const CullPlane& plane : planes) choice.offer({plane.normal[0], plane.normal[1], plane.normal[2]});
      choice.offer_octants();
      found_[index][static_cast<std::size_t>(lane)] = choice.best(most_);
    }
  }

  /// What a lane's planes are fitted to.
  BoxedPoints below(const Node& node, int lane) const {
    BoxedPoints child;
    child.box = child_box(node, lane);
    if (node.child[lane].is_inner() && config_.fit == CullPlanesConfig::Fit::kBoxes)
      append_box_corners(accel_.nodes[node.child[lane].node()], child.points);
    else
      append_corners(node.child[lane], child.points);
    return child;
  }

  // The lanes' own choices are the candidates.
  void share_normals(std::size_t index) {
    const Node& node = accel_.nodes[index];
    if (node.above_instances) return;
    std::vector<BoxedPoints> siblings;
    std::vector<std::size_t> lanes;
    std::vector<CullPlane> candidates;
    for (int lane = 0; lane < node.count; ++lane) {
      if (!wanted(node.child[lane])) continue;
      siblings.push_back(below(node, lane));
      lanes.push_back(static_cast<std::size_t>(lane));
      const std::vector<CullPlane>& own = found_[index][lanes.back()];
      candidates.insert(candidates.end(), own.begin(), own.end());
    }
    std::vector<std::vector<CullPlane>> planes = shared_planes(siblings, candidates, static_cast<int>(config_.count));
    for (std::size_t i = 0; i < lanes.size(); ++i) found_[index][lanes[i]] = std::move(planes[i]);
  }

  /// Of all triangles below, three by three.
  void append_corners(NodeRef ref, std::vector<Vec3>& out) const {
    if (ref.is_inner()) {
      const Node& node = accel_.nodes[ref.node()];
      for (int lane = 0; lane < node.count; ++lane) append_corners(node.child[lane], out);
      return;
    }
    for (std::uint32_t i = 0; i < ref.triangles(); ++i) {
      const TriangleBlock& block = accel_.blocks[ref.first_block() + i / kBlockTriangles];
      for (const auto& vertex : block.vertex)
        out.push_back({vertex[0][i % kBlockTriangles], vertex[1][i % kBlockTriangles], vertex[2][i % kBlockTriangles]});
    }
  }
  static void append_box_corners(const Node& node, std::vector<Vec3>& out) {
    for (int lane = 0; lane < node.count; ++lane) {
      const Aabb box = child_box(node, lane);
      for (int corner = 0; corner < 8; ++corner)
        out.push_back({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                       corner & 4 ? box.hi.z : box.lo.z});
    }
  }

  bool wanted(NodeRef child) const {
    using Nodes = CullPlanesConfig::Nodes;
    return config_.nodes == Nodes::kAll || child.is_inner() == (config_.nodes == Nodes::kInner);
  }

  /// Children come after their parents.
  void set_depths() {
    for (const Node& node : accel_.nodes)
      for (int lane = 0; lane < node.count; ++lane)
        if (node.child[lane].is_inner())
          accel_.nodes[node.child[lane].node()].depth = static_cast<std::uint8_t>(std::min(node.depth + 1, 255));
  }

  void store() {
    for (std::size_t i = 0; i < found_.size(); ++i) {
      Node& node = accel_.nodes[i];
      node.first_plane = static_cast<std::uint32_t>(accel_.planes.size());
      node.margin_per_reach = kMarginPerReach;
      node.least_margin = kLeastMargin;
      for (int lane = 0; lane < node.count; ++lane) {
        const std::vector<CullPlane>& planes = found_[i][static_cast<std::size_t>(lane)];
        if (!wanted(node.child[lane])) continue;
        accel_.planes.insert(accel_.planes.end(), planes.begin(), planes.end());
        node.plane_counts |= static_cast<std::uint32_t>(planes.size()) << (4 * lane);
      }
    }
    accel_.planes.shrink_to_fit();
    accel_.shared_normals = config_.shared_normals;
    accel_.planes_first = config_.order == CullPlanesConfig::Order::kPlanesFirst;
    for (const Node& node : accel_.nodes) accel_.plane_bytes += plane_bytes(node, accel_.shared_normals);
  }

  Accel& accel_;
  const CullPlanesConfig& config_;
  Executor& executor_;
  int most_;   // planes a lane to begin with
  std::vector<LanePlanes> found_;   // by node and lane
};

}  // namespace

void add_cull_planes(Accel& accel, const CullPlanesConfig& config, Executor& executor) {
  if (config.count > 0) PlaneBuilder(accel, config, executor).run();
}

}  // namespace carousel::accel
