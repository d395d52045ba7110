#pragma once

#include <algorithm>

#include "core/statistics/counters.h"

namespace carousel {

/// The effect of cull planes on the children of nodes at one depth, where a child counts once for each ray. Visits are
/// spared that would have come next; a closer hit found meanwhile would have spared some of them as well.
struct CullLevel {
  std::uint64_t children = 0, plane_tests = 0, boxes = 0, nodes = 0, leaves = 0, triangles = 0, procedural = 0;
  std::uint64_t instances = 0, transforms = 0;

  static constexpr auto counters() {
    using C = CullLevel;
    return std::array{
        Counter{"children_tested", &C::children, "children", "children whose planes were tested, once for each ray"},
        Counter{"plane_tests", &C::plane_tests, "tests", "tests of a ray against a plane of these children"},
        Counter{"culled", &C::culled, "children",
                "children whose box the ray hits and which a cull plane showed to be missed"},
        Counter{"box_tests_spared", &C::boxes, "tests", "box tests of children that their planes had culled before"},
        Counter{"nodes_spared", &C::nodes, "nodes", "culled inner nodes, which the ray did not fetch"},
        Counter{"leaves_spared", &C::leaves, "leaves", "culled leaves, which the ray did not fetch"},
        Counter{"triangle_tests_spared", &C::triangles, "tests",
                "triangles in culled leaves: an upper bound, since a closer hit may spare some as well"},
        Counter{"transforms_spared", &C::transforms, "rays",
                "rays not transformed to model space: a lower bound, since each strip of the instance may need one"},
        Counter{"procedural_tests_spared", &C::procedural, "tests", "procedural primitives in culled leaves",
                Shown::kNever},
        Counter{"instances_spared", &C::instances, "instances", "culled instances, transformed or not", Shown::kNever},
    };
  }
  constexpr std::uint64_t culled() const { return nodes + leaves + instances; }
  friend bool operator==(const CullLevel&, const CullLevel&) = default;
};

/// The effect of cull planes by depth: the distance of a node from the root of its structure, above the instances or
/// below one. Deeper nodes count as deepest.
struct CullCounts {
  static constexpr std::size_t kDepths = 32;
  std::array<CullLevel, kDepths> above{}, below{};

  CullLevel& at(bool above_instances, std::size_t depth) {
    return (above_instances ? above : below)[std::min(depth, kDepths - 1)];
  }
  CullLevel sum() const {
    CullLevel all;
    for (std::size_t depth = 0; depth < kDepths; ++depth) (all += above[depth]) += below[depth];
    return all;
  }
  CullCounts& operator+=(const CullCounts& o) {
    for (std::size_t depth = 0; depth < kDepths; ++depth) {
      above[depth] += o.above[depth];
      below[depth] += o.below[depth];
    }
    return *this;
  }
  friend bool operator==(const CullCounts&, const CullCounts&) = default;
};

}  // namespace carousel
