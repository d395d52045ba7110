#pragma once

#include "core/statistics/node_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The nodes at one depth of the structure and the work at them.
struct NodeDepth {
  std::uint64_t depth = 0;
  std::uint64_t inner = 0, leaves = 0;
  NodeCounts counts;
};

template <class V>
void describe(V& v, const NodeDepth& r) {
  v.field("depth", r.depth, "strips", "depth below the root at which rays start, the way through instances included");
  v.field("inner_nodes", r.inner, "nodes", "inner nodes at this depth, those of an instance once for each placement");
  v.field("leaves", r.leaves, "nodes", "leaves at this depth, likewise");
  describe(v, r.counts);
  v.field("rays_per_visit", ratio(r.counts.rays, r.counts.visits), "rays/packet", "rays tested in a visit");
}

struct Nodes {
  std::vector<NodeDepth> by_depth;
};

template <class V>
void describe(V& v, const Nodes& r) {
  v.section("by_depth", r.by_depth, "work at each depth from the root down");
}

}  // namespace carousel::report
