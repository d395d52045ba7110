#include "app/build_report/structure_levels.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace carousel::app {

namespace {

enum Storey : std::size_t { kTop, kGroups, kMeshes };
constexpr std::array kLevelNames{"top", "groups", "meshes"};

/// Bytes of a node or leaf. A compressed block that several leaves share counts at the first of them.
std::uint32_t own_bytes(const accel::Accel& accel, const ringbus::cycle::ShapeMemory& memory, accel::NodeRef ref) {
  if (accel.packed && !ref.is_inner() && accel.packed->place(ref).first > 0) return 0;
  return memory.strip({kNoInstance, ref}).bytes;
}

class LevelWalk {
 public:
  LevelWalk(const accel::Accel& accel, const ringbus::cycle::ShapeMemory& memory)
      : accel_(accel), memory_(memory), levels_(3) {
    for (std::size_t i = 0; i < kLevelNames.size(); ++i) levels_[i].level = kLevelNames[i];
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
      const std::uint32_t bytes = own_bytes(accel_, memory_, ref);
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

std::vector<report::StructureDepth> structure_depths(const accel::Accel& accel,
                                                     const ringbus::cycle::ShapeMemory& memory,
                                                     const ringbus::cycle::CycleResult* cycle) {
  const accel::StructureDepths& depths = *memory.depths();
  std::vector<report::StructureDepth> out;
  for (const accel::StructureDepths::Row& row : depths.rows()) {
    out.push_back({kLevelNames[static_cast<std::size_t>(row.level)], row.depth, row.inner, row.leaves, row.children, 0,
                   row.surface_cost, std::nullopt});
    if (cycle != nullptr) out.back().reads.emplace();
  }
  std::vector<bool> seen(accel.blocks.size());
  const auto add = [&](accel::NodeRef ref) {
    if (ref.is_instance()) return;
    const std::uint16_t row = depths.row(ref);
    if (row == accel::StructureDepths::kNoRow) return;
    if (!ref.is_inner()) {
      if (seen[ref.first_block()]) return;
      seen[ref.first_block()] = true;
    }
    out[row].bytes += own_bytes(accel, memory, ref);
  };
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) {
    add(accel::NodeRef::inner(n));
    for (int lane = 0; lane < accel.nodes[n].count; ++lane)
      if (!accel.nodes[n].child[lane].is_inner()) add(accel.nodes[n].child[lane]);
  }
  for (const accel::InstanceNode& instance : accel.instances)
    if (!instance.root.is_inner()) add(instance.root);
  if (!accel.root_key().ref.is_inner()) add(accel.root_key().ref);
  if (cycle == nullptr) return out;
  for (const ringbus::cycle::TileResult& tile : cycle->tiles)
    for (std::size_t row = 0; row < tile.strip_reads.size(); ++row) *out[row].reads += tile.strip_reads[row];
  return out;
}

void add_depths(const std::vector<report::StructureDepth>& depths, std::vector<report::StructureLevel>& levels) {
  for (const report::StructureDepth& depth : depths)
    for (report::StructureLevel& level : levels) {
      if (level.level != depth.level) continue;
      level.surface_cost += depth.surface_cost;
      if (!depth.reads) continue;
      if (!level.reads) level.reads.emplace();
      *level.reads += *depth.reads;
    }
}

}  // namespace carousel::app
