#include "accel/wide_collapse.h"

#include <algorithm>
#include <array>

namespace carousel::accel {

namespace {

std::uint32_t saturating_add(std::uint32_t a, std::uint32_t b) {
  return a > 0xffffffffu - b ? 0xffffffffu : a + b;
}

class Collapse {
 public:
  Collapse(const std::vector<BinaryNode>& binary, int width,
           const std::function<WideLeaf(const BinaryNode&)>& make_leaf, NodeArray& nodes)
      : binary_(binary), width_(width), make_leaf_(make_leaf), nodes_(nodes) {}

  WideTree emit(std::uint32_t at) {
    if (binary_[at].count > 0) {
      const WideLeaf leaf = make_leaf_(binary_[at]);
      return {leaf.ref, leaf.strip_size, leaf.triangles, leaf.ref.kind() == NodeRef::Kind::kLeaf ? 1 : 0};
    }
    std::array<std::uint32_t, kMaxWidth> children{binary_[at].first, binary_[at].right};
    const int count = open_largest(children);
    const std::uint32_t index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].count = static_cast<std::uint8_t>(count);
    std::uint32_t triangles = 0;
    int depth = 0;
    for (int lane = 0; lane < count; ++lane) {
      const WideTree child = emit(children[lane]);
      Node& node = nodes_[index];   // emit() may have moved the array
      const Aabb& box = binary_[children[lane]].box;
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
    return {NodeRef::inner(index), static_cast<std::uint8_t>(count), triangles, depth + 1};
  }

 private:
  int open_largest(std::array<std::uint32_t, kMaxWidth>& children) const {
    int count = 2;
    while (count < width_) {
      int largest = -1;
      float area = -1;
      for (int i = 0; i < count; ++i) {
        if (binary_[children[i]].count > 0) continue;
        const float a = binary_[children[i]].box.half_area();
        if (a > area) {
          area = a;
          largest = i;
        }
      }
      if (largest < 0) break;
      const BinaryNode& opened = binary_[children[largest]];
      children[largest] = opened.first;
      children[count++] = opened.right;
    }
    return count;
  }

  const std::vector<BinaryNode>& binary_;
  int width_;
  const std::function<WideLeaf(const BinaryNode&)>& make_leaf_;
  NodeArray& nodes_;
};

}  // namespace

WideTree collapse(const std::vector<BinaryNode>& binary, int width,
                  const std::function<WideLeaf(const BinaryNode&)>& make_leaf, NodeArray& nodes) {
  return Collapse(binary, width, make_leaf, nodes).emit(0);
}

}  // namespace carousel::accel
