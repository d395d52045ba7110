#pragma once

#include "core/statistics/cull_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// Cull planes at one depth.
struct CullPlaneLevel {
  std::string structure;
  std::uint64_t depth = 0;
  CullLevel counts;
};

template <class V>
void describe(V& v, const CullPlaneLevel& r) {
  v.field("structure", r.structure, "", "top (above the instances) or bottom (below one)");
  v.field("depth", r.depth, "nodes", "depth of the children's node below the root of its structure");
  describe(v, r.counts);
}

struct CullPlanes {
  std::uint64_t planes = 0, bytes = 0;
  double bytes_per_node = 0;
  CullCounts counts{};

  /// The depths at which planes were tested.
  std::vector<CullPlaneLevel> levels() const {
    std::vector<CullPlaneLevel> out;
    const auto add = [&](const char* structure, const auto& by_depth) {
      for (std::size_t depth = 0; depth < by_depth.size(); ++depth)
        if (by_depth[depth].children > 0) out.push_back({structure, depth, by_depth[depth]});
    };
    add("top", counts.above);
    add("bottom", counts.below);
    return out;
  }
};

template <class V>
void describe(V& v, const CullPlanes& r) {
  v.field("planes", r.planes, "planes", "cull planes of the children of all nodes");
  v.field("bytes", r.bytes, "bytes", "bytes of these planes");
  v.field("bytes_per_node", r.bytes_per_node, "bytes/node", "mean for each node, beside the 256 bytes of the node");
  v.section("levels", r.levels(), "counts at each depth at which planes were tested");
}

}  // namespace carousel::report
