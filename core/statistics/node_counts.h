#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Work at the nodes of one depth. A treelet, which one visit goes through as a whole, counts at the depth of its root.
struct NodeCounts {
  std::uint64_t visits = 0, rays = 0, box = 0, triangle = 0, children = 0, misses = 0;

  static constexpr auto counters() {
    using C = NodeCounts;
    return std::array{
        Counter{"visits", &C::visits, "packets",
                "visits of packets with rays to test, one a node where their rays are at several; idle visits are left "
                "out"},
        Counter{"rays", &C::rays, "rays", "rays tested in these visits, those of bundles included"},
        Counter{"box_tests", &C::box, "tests", "tests of a ray against a box"},
        Counter{"triangle_tests", &C::triangle, "tests", "tests of a ray against a triangle"},
        Counter{"children_hit", &C::children, "rays", "rays that went on to a child, once for each child"},
        Counter{"misses", &C::misses, "rays",
                "rays that were tested against the children of a node and went on to none"},
    };
  }
  friend bool operator==(const NodeCounts&, const NodeCounts&) = default;
};

struct NodeCountsAtDepth {
  std::uint16_t depth = 0;  ///< in strips below the root
  NodeCounts counts;
};

}  // namespace carousel
