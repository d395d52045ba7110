#include "accel/builders/file/file_blas.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "accel/builders/mesh/primitive_blocks.h"
#include "core/system/error.h"

namespace carousel::accel {

namespace {

class FileBlas {
 public:
  FileBlas(const FileTree& tree, const std::string& file, const BlasMeshes& meshes, const scene::Opacity& opacity,
           const BvhConfig& config, const BuildPrimitives& primitives)
      : tree_(tree),
        file_(file),
        meshes_(meshes),
        opacity_(opacity),
        config_(config),
        primitives_(primitives),
        parents_(tree.nodes.size()),
        seen_(primitives.size()),
        boxes_(tree.nodes.size()) {}

  Blas run() {
    if (tree_.primitive_count != primitives_.size())
      fail(tree_.line, fmt::format("expected {} with {} primitives, as the scene has it, found {}", tree_.source.text(),
                                   primitives_.size(), tree_.primitive_count));
    for (std::uint32_t node = 0; node < tree_.nodes.size(); ++node) check_node(node);
    check_all_named();
    for (auto node = static_cast<std::uint32_t>(tree_.nodes.size()); node-- > 0;) check_boxes(node);
    return build();
  }

 private:
  using Child = FileTree::Child;

  static bool is_leaf(const Child& child) { return child.node == FileTree::kLeaf; }
  const Child& child(std::uint32_t node, std::uint32_t lane) const {
    return tree_.children[tree_.nodes[node].first + lane];
  }
  std::uint32_t children(std::uint32_t node) const { return tree_.nodes[node].count; }

  void check_node(std::uint32_t node) {
    const std::uint32_t line = tree_.nodes[node].line;
    if (children(node) > static_cast<std::uint32_t>(config_.width))
      fail(line, fmt::format("expected at most {} children of a node (bvh.width), found {} of node {}", config_.width,
                             children(node), node));
    for (std::uint32_t lane = 0; lane < children(node); ++lane)
      is_leaf(child(node, lane)) ? check_leaf(node, child(node, lane)) : check_inner(node, child(node, lane));
  }

  void check_inner(std::uint32_t node, const Child& child) {
    if (child.node >= tree_.nodes.size())
      fail(child.line, fmt::format("expected one of the {} nodes of {}, found node {}", tree_.nodes.size(),
                                   tree_.source.text(), child.node));
    if (child.node <= node)
      fail(child.line, fmt::format("expected a node behind node {}, its parent, found node {}", node, child.node));
    if (parents_[child.node]++ > 0)
      fail(child.line, fmt::format("expected one parent of each node, found a second of node {}", child.node));
  }

  void check_leaf(std::uint32_t node, const Child& child) {
    if (child.count > static_cast<std::uint32_t>(config_.leaf_triangles))
      fail(child.line, fmt::format("expected at most {} primitives in a leaf (bvh.leaf_triangles), found {}",
                                   config_.leaf_triangles, child.count));
    for (std::uint32_t i = child.first; i < child.first + child.count; ++i) {
      const std::uint32_t primitive = tree_.primitives[i];
      if (primitive >= primitives_.size())
        fail(child.line, fmt::format("expected one of the {} primitives of {}, found primitive {}", primitives_.size(),
                                     tree_.source.text(), primitive));
      if (seen_[primitive])
        fail(child.line,
             fmt::format("expected each primitive in one leaf, found primitive {} in another before", primitive));
      seen_[primitive] = true;
      if (is_sphere(primitive) != is_sphere(tree_.primitives[child.first]))
        fail(child.line, fmt::format("expected triangles or spheres in a leaf, found both below node {}", node));
    }
  }
  bool is_sphere(std::uint32_t primitive) const { return primitive >= meshes_.triangles(); }

  void check_all_named() const {
    for (std::uint32_t node = 1; node < parents_.size(); ++node)
      if (parents_[node] == 0)
        fail(tree_.nodes[node].line, fmt::format("expected each node below another, found none above node {}", node));
    const auto missing = std::find(seen_.begin(), seen_.end(), false);
    if (missing != seen_.end())
      fail(tree_.line, fmt::format("expected each of the {} primitives of {} in a leaf, found primitive {} in none",
                                   seen_.size(), tree_.source.text(), missing - seen_.begin()));
  }

  /// Nodes below come first, so that boxes_ has those of all children.
  void check_boxes(std::uint32_t node) {
    for (std::uint32_t lane = 0; lane < children(node); ++lane) {
      const Child& of = child(node, lane);
      if (!is_leaf(of)) {
        const std::uint32_t fault = lane_outside(of);
        if (fault != children(of.node))
          fail(of.line, fmt::format("the box of node {} does not hold that of its child in line {}", of.node,
                                    child(of.node, fault).line));
      } else {
        for (std::uint32_t i = of.first; i < of.first + of.count; ++i) {
          const BuildPrimitive& primitive = primitives_[tree_.primitives[i]];
          if (!holds(of.box, {primitive.lo, primitive.hi}))
            fail(of.line,
                 fmt::format("the box of a leaf of node {} does not hold its primitive {}", node, tree_.primitives[i]));
        }
      }
      boxes_[node].extend(of.box);
    }
  }
  /// The first child of an inner child that lies outside its box, or the number of its children.
  std::uint32_t lane_outside(const Child& of) const {
    std::uint32_t lane = 0;
    while (lane < children(of.node) && holds(of.box, child(of.node, lane).box)) ++lane;
    return lane;
  }
  static bool holds(const Aabb& outer, const Aabb& inner) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(outer.lo[axis] <= inner.lo[axis] && inner.hi[axis] <= outer.hi[axis])) return false;
    return true;
  }

  Blas build() {
    Blas blas;
    blas.box = boxes_[0];
    // A root whose only child is a leaf stands for a structure that is this leaf.
    if (children(0) == 1 && is_leaf(child(0, 0))) {
      blas.tree = leaf(child(0, 0), blas);
      return blas;
    }
    blas.nodes.grow(tree_.nodes.size());
    blas.tree = walk(0, 1, blas);
    return blas;
  }

  WideTree walk(std::uint32_t at, int depth, Blas& blas) {
    if (depth > kFileTreeDepth)
      fail(tree_.nodes[at].line,
           fmt::format("expected at most {} nodes on a way down, found more above node {}", kFileTreeDepth, at));
    Node node;
    int below = 0;
    for (std::uint32_t lane = 0; lane < children(at); ++lane) {
      const Child& of = child(at, lane);
      const WideTree tree = is_leaf(of) ? leaf(of, blas) : walk(of.node, depth + 1, blas);
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[axis][lane] = of.box.lo[axis];
        node.plane[axis + 3][lane] = of.box.hi[axis];
      }
      node.child[lane] = tree.root;
      node.strip_size[lane] = tree.root_strip_size;
      node.triangles += tree.triangles;
      below = std::max(below, tree.depth);
    }
    node.count = static_cast<std::uint8_t>(children(at));
    blas.nodes[at] = node;
    return {NodeRef::inner(at), node.count, node.triangles, below + 1};
  }

  WideTree leaf(const Child& of, Blas& blas) {
    const auto first_block = static_cast<std::uint32_t>(blas.blocks.size());
    const std::uint32_t* const primitives = tree_.primitives.data() + of.first;
    for (std::uint32_t begin = 0; begin < of.count; begin += kBlockTriangles) {
      TriangleBlock block;
      const std::uint32_t count = std::min<std::uint32_t>(kBlockTriangles, of.count - begin);
      blas.has_non_opaque |= fill_block(meshes_, opacity_, primitives + begin, count, block);
      blas.blocks.push_back(block);
    }
    const NodeRef ref =
        is_sphere(*primitives) ? NodeRef::procedural(first_block, of.count) : NodeRef::leaf(first_block, of.count);
    return {ref, static_cast<std::uint8_t>(of.count), of.count, 1};
  }

  [[noreturn]] void fail(std::uint32_t line, const std::string& message) const {
    throw SceneError(fmt::format("{}:{}", file_, line), "", message);
  }

  const FileTree& tree_;
  const std::string& file_;
  const BlasMeshes& meshes_;
  const scene::Opacity& opacity_;
  const BvhConfig& config_;
  const BuildPrimitives& primitives_;
  std::vector<std::uint32_t> parents_;  // by node
  std::vector<bool> seen_;              // by primitive: in a leaf
  std::vector<Aabb> boxes_;             // by node
};

}  // namespace

Blas blas_of_file(const FileTree& tree, const std::string& file, const BlasMeshes& meshes,
                  const scene::Opacity& opacity, const BvhConfig& config, Executor& executor) {
  return FileBlas(tree, file, meshes, opacity, config, primitive_boxes(meshes, executor)).run();
}

}  // namespace carousel::accel
