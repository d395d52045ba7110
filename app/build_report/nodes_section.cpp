#include "app/build_report/nodes_section.h"

#include <algorithm>
#include <unordered_map>

namespace carousel::app {

namespace {

struct LevelNodes {
  std::uint64_t inner = 0, leaves = 0;
};
using Levels = std::vector<LevelNodes>;  // by depth

/// Counts the nodes below roots. A mesh or a group is gone through once, however often it is placed.
class NodeCounter {
 public:
  explicit NodeCounter(const accel::Accel& accel) : accel_(accel) {}

  Levels below(accel::NodeKey root) {
    struct Open {
      accel::NodeKey key;
      std::size_t depth;
    };
    Levels levels;
    std::vector<Open> open{{root, 0}};
    while (!open.empty()) {
      const auto [key, depth] = open.back();
      open.pop_back();
      add(levels, {key.ref.is_inner() ? LevelNodes{1, 0} : LevelNodes{0, 1}}, depth);
      if (!key.ref.is_inner()) continue;
      const accel::Node& node = accel_.nodes[key.ref.node()];
      for (int lane = 0; lane < node.count; ++lane) {
        const accel::NodeKey child = accel_.child_key(key, lane);
        if (node.child[lane].is_instance())
          add(levels, placed(child), depth + 1);
        else
          open.push_back({child, depth + 1});
      }
    }
    return levels;
  }

 private:
  static void add(Levels& to, const Levels& from, std::size_t depth) {
    to.resize(std::max(to.size(), depth + from.size()));
    for (std::size_t i = 0; i < from.size(); ++i) {
      to[depth + i].inner += from[i].inner;
      to[depth + i].leaves += from[i].leaves;
    }
  }

  const Levels& placed(accel::NodeKey root) {
    const auto known = placed_.find(root.ref.bits());
    return known != placed_.end() ? known->second : placed_.emplace(root.ref.bits(), below(root)).first->second;
  }

  const accel::Accel& accel_;
  std::unordered_map<std::uint32_t, Levels> placed_;  // by root
};

}  // namespace

report::Nodes nodes_section(const accel::Accel& accel, const std::vector<NodeCounts>& work) {
  const Levels levels = NodeCounter(accel).below(accel.root_key());
  report::Nodes out;
  for (std::size_t depth = 0; depth < std::max(levels.size(), work.size()); ++depth) {
    report::NodeDepth& row = out.by_depth.emplace_back();
    row.depth = depth;
    if (depth < levels.size()) {
      row.inner = levels[depth].inner;
      row.leaves = levels[depth].leaves;
    }
    if (depth < work.size()) row.counts = work[depth];
  }
  return out;
}

}  // namespace carousel::app
