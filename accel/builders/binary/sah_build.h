#pragma once

#include <cstdint>
#include <vector>

#include "core/system/executor.h"
#include "core/system/huge_pages.h"
#include "core/system/uninitialised.h"
#include "core/types/aabb.h"

namespace carousel::accel {

/// A primitive to build over: its box and where it came from.
struct alignas(32) BuildPrimitive {
  Vec3 lo;
  std::uint32_t index;
  Vec3 hi;
  std::uint32_t unused = 0;
};

/// Node of the intermediate binary tree. Leaves hold primitives [first, first + count); inner nodes have
/// count == 0 and their children at `first` (left) and `right`.
struct BinaryNode {
  Aabb box;
  std::uint32_t first = 0;
  std::uint32_t right = 0;
  std::uint32_t count = 0;
};

// Elements made without a value have none.
using BuildPrimitives =
    std::vector<BuildPrimitive, UninitialisedAllocator<BuildPrimitive, HugePageAllocator<BuildPrimitive>>>;
/// Node 0 is the root. Not every place holds a node.
using BinaryTree = std::vector<BinaryNode, UninitialisedAllocator<BinaryNode>>;

/// A stack entry is spent per level and the traversal stack is fixed; below this depth splits are by halves.
inline constexpr int kSahDepth = 40;

struct SahSettings {
  std::uint32_t leaf_primitives = 4;   ///< at most so many in a leaf
  std::uint32_t block_primitives = 4;  ///< tested at the price of one (SIMD width of a leaf)
  float traversal_cost = 1.0f;         ///< cost of a binary split, in block tests
};

/// Binned surface-area heuristic (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies").
/// Reorders `primitives` so that leaves are ranges, in the order of the tree. The places of nodes depend on the counts
/// alone, so the tree is the same for any executor. `primitives` must not be empty. Boxes are finite.
BinaryTree build_sah(BuildPrimitives& primitives, const SahSettings& settings, Executor& executor);

}  // namespace carousel::accel
