#include "app/build_report/structure_levels.h"

#include <algorithm>
#include <set>
#include <utility>

namespace carousel::app {

namespace {

enum Storey : std::size_t { kTop, kGroups, kMeshes };

class LevelWalk {
 public:
  LevelWalk(const accel::Accel& accel, const ringbus::cycle::ShapeMemory& memory)
      : accel_(accel), memory_(memory), levels_(3) {
    levels_[kTop].level = "top";
    levels_[kGroups].level = "groups";
    levels_[kMeshes].level = "meshes";
  }

  std::vector<report::StructureLevel> run() {
    const accel::NodeKey root = accel_.root_key();
    if (root.instance != kNoInstance)
      enter(root.instance);
    else
      found(kTop, root);
    while (!open_.empty()) {
      const auto [level, key] = open_.back();
      open_.pop_back();
      walk(level, key);
    }
    if (levels_[kGroups].structures == 0) levels_.erase(levels_.begin() + kGroups);
    return std::move(levels_);
  }

 private:
  void found(Storey level, accel::NodeKey root) {
    if (seen_.insert({level, root.ref.bits()}).second) open_.push_back({level, root});
  }

  void enter(std::uint32_t instance) {
    const Storey level = accel_.is_group(instance) ? kGroups : kMeshes;
    ++levels_[level].instances;
    levels_[level].record_bytes += memory_.transform(instance).bytes;
    found(level, {instance, accel_.instances[instance].root});
  }

  void walk(Storey level, accel::NodeKey root) {
    struct Open {
      accel::NodeRef ref;
      std::uint64_t depth;
    };
    report::StructureLevel& out = levels_[level];
    ++out.structures;
    std::vector<Open> open{{root.ref, 1}};
    while (!open.empty()) {
      const auto [ref, depth] = open.back();
      open.pop_back();
      out.depth = std::max(out.depth, depth);
      const std::uint32_t bytes = memory_.strip({root.instance, ref}).bytes;
      if (!ref.is_inner()) {
        ++out.leaves;
        out.leaf_bytes += bytes;
        continue;
      }
      const accel::Node& node = accel_.nodes[ref.node()];
      ++out.inner_nodes;
      out.node_bytes += bytes;
      out.children += node.count;
      for (int lane = 0; lane < node.count; ++lane) {
        const accel::NodeRef child = node.child[lane];
        if (child.is_instance())
          enter(accel_.instance_at(root.instance, child));
        else if (level == kTop && !(child.is_inner() && accel_.nodes[child.node()].above_instances))
          found(kMeshes, {kNoInstance, child});  // the root of merged meshes
        else
          open.push_back({child, depth + 1});
      }
    }
  }

  const accel::Accel& accel_;
  const ringbus::cycle::ShapeMemory& memory_;
  std::vector<report::StructureLevel> levels_;
  std::vector<std::pair<Storey, accel::NodeKey>> open_;
  std::set<std::pair<Storey, std::uint32_t>> seen_;
};

}  // namespace

std::vector<report::StructureLevel> structure_levels(const accel::Accel& accel,
                                                     const ringbus::cycle::ShapeMemory& memory) {
  return LevelWalk(accel, memory).run();
}

}  // namespace carousel::app
