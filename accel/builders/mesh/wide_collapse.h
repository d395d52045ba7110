#pragma once

#include <functional>
#include <vector>

#include "accel/builders/binary/sah_build.h"
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

/// The primitives of a block of a leaf, by their places.
struct BlockPrimitives {
  std::uint32_t first, count;
};
/// The primitives of consecutive blocks, block by block.
struct BlockRun {
  std::uint32_t first_block = 0;
  std::vector<BlockPrimitives> blocks;
};

/// Makes a leaf of triangles or procedural primitives whose blocks start at `first_block`, or of anything else.
using MakeLeaf = std::function<WideLeaf(const BinaryNode& leaf, std::uint32_t first_block)>;

/// Turns a binary tree into nodes of up to `width` children, appended to `nodes` depth-first, so that the areas of
/// all nodes add up to the least possible (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs
/// through compressed wide BVHs", section 3.2; leaves stay as they are). A tree that is one leaf has that leaf as its
/// root.
/// `make_leaf` is called once a leaf, by any thread. Blocks are numbered from 0, in depth-first order, and their
/// primitives go to `runs`, unless it is null: then no leaf has any. The outcome is the same for any executor.
WideTree collapse(const BinaryTree& binary, int width, const MakeLeaf& make_leaf, Executor& executor, NodeArray& nodes,
                  std::vector<BlockRun>* runs = nullptr);

}  // namespace carousel::accel
