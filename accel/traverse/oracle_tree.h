#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/aabb.h"

namespace carousel::accel {

/// A binary tree over boxes, each divided at the median of its centres along the longest axis: plain, so that it can be
/// trusted, and unlike every structure that a run may use. Immutable once built; any thread may read.
class OracleTree {
 public:
  /// `item_box(i)` is the box of item i, for i below `count`. Empty boxes are left out.
  template <class ItemBox>
  OracleTree(std::uint32_t count, const ItemBox& item_box) {
    std::vector<Aabb> boxes;
    for (std::uint32_t i = 0; i < count; ++i)
      if (const Aabb box = item_box(i); !box.empty()) {
        items_.push_back(i);
        boxes.push_back(box);
      }
    build(boxes);
  }

  /// Around all items; empty for none.
  Aabb box() const { return nodes_.empty() ? Aabb{} : nodes_[0].box; }
  /// Most bytes of a tree over `items`: a leaf has at least two items, unless there is only one.
  static std::size_t most_bytes(std::size_t items) {
    return items * (sizeof(Node) + sizeof(std::uint32_t)) + sizeof(Node);
  }
  std::size_t size_bytes() const { return nodes_.size() * sizeof(Node) + items_.size() * sizeof(std::uint32_t); }

  /// Calls `visit(item)` for the items of all leaves that `enters(box, entry)` lets in, nearer ones first as far as
  /// entries tell. `visit` returns false to end the walk.
  template <class Enters, class Visit>
  void walk(const Enters& enters, const Visit& visit) const {
    float entry;
    if (nodes_.empty() || !enters(nodes_[0].box, entry)) return;
    std::array<std::uint32_t, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node* node = &nodes_[stack[--depth]];
      if (!enters(node->box, entry)) continue;  // a nearer hit may have been found since
      if (node->count > 0) {
        for (std::uint32_t i = 0; i < node->count; ++i)
          if (!visit(items_[node->first + i])) return;
        continue;
      }
      const std::uint32_t children[2] = {node->first, node->first + 1};
      float entries[2];
      const bool met[2] = {enters(nodes_[children[0]].box, entries[0]), enters(nodes_[children[1]].box, entries[1])};
      const int nearer = met[0] && met[1] && entries[1] < entries[0] ? 1 : 0;
      if (met[1 - nearer]) stack[depth++] = children[1 - nearer];
      if (met[nearer]) stack[depth++] = children[nearer];
    }
  }

 private:
  struct Node {
    Aabb box;
    std::uint32_t first;  ///< first of a leaf's items, or first of two children
    std::uint32_t count;  ///< items; 0: not a leaf
  };
  static constexpr std::uint32_t kLeafItems = 4;
  static constexpr std::size_t kMaxDepth = 64;  // halves of 2^32 items

  void build(std::span<const Aabb> boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace carousel::accel
