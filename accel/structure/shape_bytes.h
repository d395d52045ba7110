#pragma once

#include <cstdint>

#include "accel/structure/accel.h"
#include "core/config/fields/bvh.h"

namespace carousel::accel {

// A node's origin, scales, references and kinds, and 6 bytes a child: H. Ylitie et al., HPG 2017, of 8 children in 80
// bytes; of 6 children in 64, as Vulkan-Sim (M. Saed et al., MICRO 2022) reads them, with a leaf of 64 bytes a
// triangle.
inline constexpr std::uint32_t kSmallNodeBytes = 64, kSmallWidth = 6, kLargeNodeBytes = 80, kQuantisedLeafBytes = 64;

// With 12 bits a plane 9 bytes a child for its box and 4 for its reference, and beside these an origin, scales and
// kinds.
inline constexpr std::uint32_t kQuantised12Bytes = 128;

/// Bytes of a node in the machine's memory, without what stands behind it.
inline std::uint32_t node_bytes(const Accel& accel, const BvhConfig& bvh) {
  if (bvh.storage == BvhConfig::Storage::kQuantised12) return kQuantised12Bytes;
  if (bvh.storage == BvhConfig::Storage::kQuantised)
    return bvh.width <= kSmallWidth ? kSmallNodeBytes : kLargeNodeBytes;
  if (accel.elements.empty()) return sizeof(Node);
  return static_cast<std::uint32_t>(sizeof(Node) - sizeof(Node::plane) + accel.elements.node_bytes());
}

/// Bytes that stand behind a node: its children's cull planes, and the primitives that it holds itself, with their
/// micromaps.
inline std::uint32_t bytes_behind(const Accel& accel, const Node& node) {
  std::uint64_t bytes = plane_bytes(node, accel.shared_normals);
  for (int lane = 0; lane < node.count; ++lane)
    if (node.direct >> lane & 1) {
      const NodeRef leaf = accel.held_leaf(node, lane);
      bytes += leaf.blocks() * sizeof(TriangleBlock) + accel.micromaps.places.of(leaf);
    }
  return static_cast<std::uint32_t>(bytes);
}

/// Bytes of a leaf of triangles, or of procedural primitives, that is not stored as strips or in compressed blocks.
inline std::uint32_t leaf_bytes(NodeRef leaf, BvhConfig::Storage storage) {
  if (is_quantised(storage)) return leaf.triangles() * kQuantisedLeafBytes;
  return leaf.blocks() * static_cast<std::uint32_t>(sizeof(TriangleBlock));
}

}  // namespace carousel::accel
