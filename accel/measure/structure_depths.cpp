#include "accel/measure/structure_depths.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "accel/structure/cull_plane.h"
#include "core/types/aabb.h"

namespace carousel::accel {

namespace {

using Level = StructureDepths::Level;
constexpr std::size_t kLevels = 3, kMostDepth = 4095;

/// Goes through the structures of all levels, each once.
class DepthWalk {
 public:
  explicit DepthWalk(const Accel& accel) : accel_(accel) {}

  struct Found {
    NodeRef ref;
    std::size_t depth;
    double visits;  // of a line through the box of the structure, times its weight
  };
  std::array<std::vector<Found>, kLevels> found;
  std::array<double, kLevels> weights{};

  void run() {
    const NodeKey root = accel_.root_key();
    if (root.instance != kNoInstance)
      enter(root.instance);
    else
      open(Level::kTop, root);
    while (!open_.empty()) {
      const auto [level, key] = open_.back();
      open_.pop_back();
      walk(level, key);
    }
  }

 private:
  void open(Level level, NodeKey root) {
    if (seen_.insert({level, root.ref.bits()}).second) open_.push_back({level, root});
  }
  void enter(std::uint32_t instance) {
    open(accel_.is_group(instance) ? Level::kGroups : Level::kMeshes, {instance, accel_.instances[instance].root});
  }

  void walk(Level level, NodeKey root) {
    struct Open {
      NodeRef ref;
      std::size_t depth;
      double area;
    };
    double whole = 0;
    if (root.ref.is_inner()) {
      const Node& node = accel_.nodes[root.ref.node()];
      Aabb box;
      for (int lane = 0; lane < node.count; ++lane) box.extend(child_box(node, lane));
      whole = box.half_area();
    }
    std::vector<Found>& out = found[static_cast<std::size_t>(level)];
    const std::size_t first = out.size();
    double references = 0;
    std::vector<Open> open_here{{root.ref, 0, whole}};
    while (!open_here.empty()) {
      const Open at = open_here.back();
      open_here.pop_back();
      const double chance = whole > 0 ? at.area / whole : 1;
      out.push_back({at.ref, std::min(at.depth, kMostDepth), at.ref.is_inner() ? chance : chance * at.ref.blocks()});
      if (!at.ref.is_inner()) {
        references += at.ref.triangles();
        continue;
      }
      const Node& node = accel_.nodes[at.ref.node()];
      for (int lane = 0; lane < node.count; ++lane) {
        const NodeRef child = node.child[lane];
        if (child.is_instance()) {
          enter(accel_.instance_at(root.instance, child));
          ++references;
        } else if (level == Level::kTop && !(child.is_inner() && accel_.nodes[child.node()].above_instances)) {
          open(Level::kMeshes, {kNoInstance, child});  // the root of merged meshes
          ++references;
        } else {
          open_here.push_back({child, at.depth + 1, child_box(node, lane).half_area()});
        }
      }
    }
    for (std::size_t i = first; i < out.size(); ++i) out[i].visits *= references;
    weights[static_cast<std::size_t>(level)] += references;
  }

  const Accel& accel_;
  std::vector<std::pair<Level, NodeKey>> open_;
  std::set<std::pair<Level, std::uint32_t>> seen_;
};

}  // namespace

StructureDepths::StructureDepths(const Accel& accel)
    : of_node_(accel.nodes.size(), kNoRow), of_leaf_(accel.blocks.size(), kNoRow) {
  DepthWalk walk(accel);
  walk.run();
  for (std::size_t level = 0; level < kLevels; ++level) {
    const std::size_t first = rows_.size();
    for (const DepthWalk::Found& one : walk.found[level]) {
      while (rows_.size() <= first + one.depth)
        rows_.push_back({static_cast<Level>(level), static_cast<std::uint32_t>(rows_.size() - first)});
      Row& row = rows_[first + one.depth];
      if (walk.weights[level] > 0) row.surface_cost += one.visits / walk.weights[level];
      const auto number = static_cast<std::uint16_t>(first + one.depth);
      if (one.ref.is_inner()) {
        ++row.inner;
        row.children += accel.nodes[one.ref.node()].count;
        of_node_[one.ref.node()] = number;
      } else {
        ++row.leaves;
        of_leaf_[one.ref.first_block()] = number;
      }
    }
  }
}

}  // namespace carousel::accel
