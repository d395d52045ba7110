#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace carousel {

/// What cull planes did for the children of nodes at one depth, each child of a ray counted. What is spared are visits
/// that would have come next: of those, some a closer hit found meanwhile would have spared as well.
struct CullLevel {
  std::uint64_t children = 0;  ///< whose planes were tested
  std::uint64_t plane_tests = 0;
  std::uint64_t boxes = 0;       ///< box tests spared, with planes tested before boxes
  std::uint64_t nodes = 0;       ///< inner children whose box the ray hits, and which it does not visit
  std::uint64_t leaves = 0;      ///< the same of leaves
  std::uint64_t triangles = 0;   ///< in those leaves: what they hold, each of which would have been tested
  std::uint64_t procedural = 0;  ///< likewise procedural primitives
  std::uint64_t instances = 0;   ///< the same of instances
  std::uint64_t transforms = 0;  ///< instances among them with a transform: entering costs one at least

  std::uint64_t culled() const { return nodes + leaves + instances; }
  CullLevel& operator+=(const CullLevel& o) {
    children += o.children;
    plane_tests += o.plane_tests;
    boxes += o.boxes;
    nodes += o.nodes;
    leaves += o.leaves;
    triangles += o.triangles;
    procedural += o.procedural;
    instances += o.instances;
    transforms += o.transforms;
    return *this;
  }
  friend bool operator==(const CullLevel&, const CullLevel&) = default;
};

/// The same by depth: a node's distance from the root of its structure, above the instances or below one. Whatever is
/// deeper counts as deepest.
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
