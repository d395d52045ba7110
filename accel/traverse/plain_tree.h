#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// A box of doubles.
struct WideBox {
  double lo[3] = {kNothing, kNothing, kNothing}, hi[3] = {-kNothing, -kNothing, -kNothing};

  void extend(const WideBox& other);
  /// The box of R box + T, made larger by more than doubles are off.
  WideBox placed(const scene::Affine& m) const;
  /// True if the line meets the box between tmin and tmax, or nearly so; `entry` is then no later than the exact entry.
  bool meets(const Ray& ray, double tmax, double& entry) const;

 private:
  static constexpr double kNothing = kInfinity;
};

/// A binary tree over boxes, halved at the middle of the longest side until few are left: for a reference, which shares
/// nothing with the structures that it judges (accel/builders). Immutable once built.
class PlainTree {
 public:
  struct Node {
    WideBox box;
    std::uint32_t first = 0;  ///< first of its items; for an inner node, the first of its two children
    std::uint32_t count = 0;  ///< 0: an inner node
  };

  PlainTree() = default;
  explicit PlainTree(std::span<const WideBox> boxes);

  bool empty() const { return nodes_.empty(); }
  const Node& node(std::uint32_t index) const { return nodes_[index]; }  ///< 0: the root
  /// The numbers of the boxes in a leaf.
  std::span<const std::uint32_t> items(const Node& leaf) const { return {&order_[leaf.first], leaf.count}; }

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace carousel::accel
