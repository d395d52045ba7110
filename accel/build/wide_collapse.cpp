#include "accel/build/wide_collapse.h"

#include <algorithm>
#include <array>
#include <memory>

namespace carousel::accel {

namespace {

std::uint32_t saturating_add(std::uint32_t a, std::uint32_t b) {
  return a > 0xffffffffu - b ? 0xffffffffu : a + b;
}

class Collapse {
 public:
  Collapse(const std::vector<BinaryNode>& binary, int width,
           const std::function<WideLeaf(const BinaryNode&)>& make_leaf, NodeArray& nodes)
      : binary_(binary),
        width_(width),
        make_leaf_(make_leaf),
        nodes_(nodes),
        shares_(std::make_unique_for_overwrite<Shares[]>(binary.size())) {}

  WideTree run() {
    price(0);
    return emit(0);
  }

 private:
  /// [i]: the least area of wide nodes that a subtree needs when its parent has i + 1 places for it.
  using Prices = std::array<float, kMaxWidth>;
  /// [i]: of i + 1 places, those that go to the left child; kWhole when one place does as well.
  using Shares = std::array<std::uint8_t, kMaxWidth>;
  static constexpr std::uint8_t kWhole = 0;

  Prices price(std::uint32_t at) {
    Prices prices{};
    const BinaryNode& node = binary_[at];
    if (node.count > 0) return prices;  // a leaf costs the same wherever it hangs
    const Prices left = price(node.first), right = price(node.right);
    Shares& shares = shares_[at];
    const std::size_t width = static_cast<std::size_t>(width_);
    for (std::size_t i = 1; i < width; ++i) {
      prices[i] = left[0] + right[i - 1];
      shares[i] = 1;
      for (std::size_t k = 1; k < i; ++k) {
        const float price = left[k] + right[i - 1 - k];
        if (price < prices[i]) {
          prices[i] = price;
          shares[i] = static_cast<std::uint8_t>(k + 1);
        }
      }
    }
    // As a node of its own, its children have all places of that node.
    shares[0] = shares[width - 1];
    prices[0] = prices[width - 1] + node.box.half_area();
    for (std::size_t i = 1; i < width; ++i) {
      if (!(prices[0] < prices[i])) continue;
      prices[i] = prices[0];
      shares[i] = kWhole;
    }
    return prices;
  }

  struct Children {
    std::array<std::uint32_t, kMaxWidth> nodes;
    int count = 0;
  };

  /// Appends what stands in the `places` places that `at` has been given.
  void place(std::uint32_t at, int places, Children& out) const {
    const bool whole =
        places == 1 || binary_[at].count > 0 || shares_[at][static_cast<std::size_t>(places - 1)] == kWhole;
    if (whole)
      out.nodes[static_cast<std::size_t>(out.count++)] = at;
    else
      open(at, places, shares_[at][static_cast<std::size_t>(places - 1)], out);
  }
  void open(std::uint32_t at, int places, int left, Children& out) const {
    place(binary_[at].first, left, out);
    place(binary_[at].right, places - left, out);
  }

  WideTree emit(std::uint32_t at) {
    if (binary_[at].count > 0) {
      const WideLeaf leaf = make_leaf_(binary_[at]);
      return {leaf.ref, leaf.strip_size, leaf.triangles, leaf.ref.is_instance() ? 0 : 1};
    }
    Children children;
    open(at, width_, shares_[at][0], children);
    const std::uint32_t index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].count = static_cast<std::uint8_t>(children.count);
    std::uint32_t triangles = 0;
    int depth = 0;
    for (int lane = 0; lane < children.count; ++lane) {
      const std::uint32_t below = children.nodes[static_cast<std::size_t>(lane)];
      const WideTree child = emit(below);
      Node& node = nodes_[index];  // emit() may have moved the array
      const Aabb& box = binary_[below].box;
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[axis][lane] = box.lo[axis];
        node.plane[axis + 3][lane] = box.hi[axis];
      }
      node.child[lane] = child.root;
      node.strip_size[lane] = child.root_strip_size;
      triangles = saturating_add(triangles, child.triangles);
      depth = std::max(depth, child.depth);
    }
    nodes_[index].triangles = triangles;
    return {NodeRef::inner(index), static_cast<std::uint8_t>(children.count), triangles, depth + 1};
  }

  const std::vector<BinaryNode>& binary_;
  int width_;
  const std::function<WideLeaf(const BinaryNode&)>& make_leaf_;
  NodeArray& nodes_;
  std::unique_ptr<Shares[]> shares_;  // by binary node
};

}  // namespace

WideTree collapse(const std::vector<BinaryNode>& binary, int width,
                  const std::function<WideLeaf(const BinaryNode&)>& make_leaf, NodeArray& nodes) {
  return Collapse(binary, width, make_leaf, nodes).run();
}

}  // namespace carousel::accel
