#include "app/build_report/levels_section.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

namespace carousel::app {

namespace {

/// A group's structure: its own nodes, and the levels from it down.
struct GroupStructure {
  std::uint64_t nodes = 0, levels = 0;
};

class GroupStructures {
 public:
  explicit GroupStructures(const accel::Accel& accel) : accel_(accel) {}

  /// The structure of an instance's group. A mesh is one level and has no nodes of a group.
  const GroupStructure& of(std::uint32_t instance) {
    static const GroupStructure kMesh{0, 1};
    if (!accel_.is_group(instance)) return kMesh;
    const std::uint32_t root = accel_.instances[instance].root.bits();
    if (const auto known = known_.find(root); known != known_.end()) return known->second;
    GroupStructure out{0, 1};
    std::vector<accel::NodeKey> open{{instance, accel_.instances[instance].root}};
    while (!open.empty()) {
      const accel::NodeKey key = open.back();
      open.pop_back();
      ++out.nodes;
      const accel::Node& node = accel_.nodes[key.ref.node()];
      for (int lane = 0; lane < node.count; ++lane) {
        const accel::NodeKey child = accel_.child_key(key, lane);
        if (node.child[lane].is_instance())
          out.levels = std::max(out.levels, 1 + of(child.instance).levels);
        else
          open.push_back(child);
      }
    }
    return known_.emplace(root, out).first->second;
  }
  const std::unordered_map<std::uint32_t, GroupStructure>& known() const { return known_; }

 private:
  const accel::Accel& accel_;
  std::unordered_map<std::uint32_t, GroupStructure> known_;  // by root
};

}  // namespace

report::Levels levels_section(const accel::Accel& accel) {
  report::Levels out;
  GroupStructures structures(accel);
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i) {
    if (!accel.is_group(i)) continue;
    out.nodes_of_groups_unshared += structures.of(i).nodes;
    if (!accel.instances[i].member) out.levels = std::max(out.levels, 1 + structures.of(i).levels);
  }
  for (const auto& [root, structure] : structures.known()) out.nodes_of_groups += structure.nodes;
  out.groups = structures.known().size();
  out.placements = accel.groups.size();
  out.nodes = accel.nodes.size();
  out.node_bytes = out.nodes * sizeof(accel::Node);
  out.node_bytes_unshared = out.node_bytes + (out.nodes_of_groups_unshared - out.nodes_of_groups) * sizeof(accel::Node);
  out.placement_bytes = out.placements * (sizeof(accel::InstanceNode) + sizeof(accel::GroupPlacement)) +
                        accel.members.size() * sizeof(std::uint32_t);
  return out;
}

}  // namespace carousel::app
