#pragma once

#include <functional>
#include <vector>

#include "accel/build/binary/sah_build.h"
#include "accel/structure/node.h"

namespace carousel::accel {

/// A leaf of the wide tree, made from a leaf of the binary one.
struct WideLeaf {
  NodeRef ref;
  std::uint8_t strip_size = 0;
  std::uint32_t triangles = 0;
};

struct WideTree {
  NodeRef root;
  std::uint8_t root_strip_size = 0;
  std::uint32_t triangles = 0;
  int depth = 0;  ///< strips on the longest way down, a triangle leaf counted as one
};

/// Turns a binary tree into nodes of up to `width` children, appended to `nodes` depth-first, so that the areas of
/// all nodes add up to the least possible (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs
/// through compressed wide BVHs", section 3.2; leaves stay as they are).
/// `make_leaf` is called once a leaf, in depth-first order. A tree that is one leaf has that leaf as its root.
WideTree collapse(const std::vector<BinaryNode>& binary, int width,
                  const std::function<WideLeaf(const BinaryNode&)>& make_leaf, NodeArray& nodes);

}  // namespace carousel::accel
