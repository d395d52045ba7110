#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/aabb.h"

namespace carousel::accel {

/// A tree as it is: a node with children, or a place at its end for so many items. Number 0 is the root.
struct DealtNode {
  std::vector<std::uint32_t> children{};  ///< each behind its parent
  std::uint32_t items = 0;                ///< below it, or in it
};

/// A primitive, or a subtree that stays as it is.
struct DealtItem {
  Aabb box{};
  std::uint32_t id = 0;
};

/// Deals items out to the places of a tree, from its root down. The children of a node are parted in two, and their
/// items with them: along each axis, in the order of the middles of their boxes, and then of their numbers, for each
/// set of children that may have the first items, a set by the bits of a number. The parting is taken for which the
/// areas of both boxes add up to the least, each times the levels of a binary tree of its items: of n = 2^e + r, r <
/// 2^e, these are e + n / 2^e. Of equal partings the first is taken. Then each part is parted. Brings `items` into the
/// order of the places, depth first. Returns how often an item was added to a box, with the boxes of all axes at a
/// time: twice a parting, from either end. Deterministic.
std::uint64_t deal(std::span<const DealtNode> tree, std::vector<DealtItem>& items);

/// The areas of all nodes and places below the root, a place counted once for each `block` items. This is what an
/// arrangement costs in visits, but for the area of the whole.
double dealt_area(std::span<const DealtNode> tree, std::span<const DealtItem> items, std::uint32_t block);

}  // namespace carousel::accel
