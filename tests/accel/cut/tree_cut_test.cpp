// The tree cut into connected pieces (bvh.treelets): what a machine relies on, for trees of all kinds.
#include "accel/cut/tree_cut.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "accel/structure/shape_bytes.h"
#include "tests/accel/structure/test_scenes.h"

namespace carousel::accel {
namespace {

/// Goes down from every root of a structure, and through every piece from its root alone.
class CutCheck {
 public:
  CutCheck(const Accel& accel, const BvhConfig& bvh) : accel_(accel), bvh_(bvh), cut_(*accel.pieces) {}

  void check() {
    ASSERT_FALSE(cut_.pieces.empty());
    std::uint64_t end = 0;
    for (const TreePieces::Piece& piece : cut_.pieces) {
      EXPECT_EQ(piece.address, (end + 63) / 64 * 64) << "pieces stand one behind another";
      end = piece.address + piece.bytes;
      go_through(piece);
    }
    EXPECT_EQ(cut_.bytes, (end + 63) / 64 * 64);
    for (std::uint32_t n = 0; n < accel_.nodes.size(); ++n)
      EXPECT_EQ(seen_nodes_[n], cut_.holds(NodeRef::inner(n)) ? 1 : 0) << "node " << n;
    go_down(accel_.root_key());
    for (std::uint32_t n = 0; n < accel_.nodes.size(); ++n)
      EXPECT_EQ(reached_[n], cut_.holds(NodeRef::inner(n))) << "node " << n;
  }

 private:
  /// All that a ray can come to has its place.
  void go_down(NodeKey key) {
    EXPECT_TRUE(cut_.holds(key.ref));
    if (!key.ref.is_inner() || reached_[key.ref.node()]) return;
    reached_[key.ref.node()] = true;
    const Node& node = accel_.nodes[key.ref.node()];
    for (int lane = 0; lane < node.count; ++lane)
      if ((node.direct >> lane & 1) == 0) go_down(accel_.child_key(key, lane));
  }

  /// Node `n` is `key` or below it, without a way into an instance.
  bool in_top(NodeKey key, std::uint32_t n) const {
    if (key.instance != kNoInstance || !key.ref.is_inner()) return false;
    if (key.ref.node() == n) return true;
    const Node& node = accel_.nodes[key.ref.node()];
    for (int lane = 0; lane < node.count; ++lane)
      if (node.above_instances && in_top({kNoInstance, node.child[lane]}, n)) return true;
    return false;
  }
  std::uint32_t bytes_of(NodeRef ref) const {
    if (!ref.is_inner()) return leaf_bytes(ref, bvh_.storage);
    return node_bytes(accel_, bvh_) + bytes_behind(accel_, accel_.nodes[ref.node()]) + extra(ref.node());
  }
  /// Nodes of the top level above moved instances keep their boxes as floats. Those of groups have no world boxes.
  std::uint32_t extra(std::uint32_t n) const {
    if (bvh_.storage != BvhConfig::Storage::kQuantised) return 0;
    const Node& node = accel_.nodes[n];
    if (!in_top(accel_.root_key(), n)) return 0;
    bool full = false;
    for (int lane = 0; node.above_instances && lane < node.count; ++lane)
      if (node.child[lane].is_instance()) {
        const InstanceNode& instance = accel_.instances[node.child[lane].instance_index()];
        full |= !instance.transform.identity && !instance.group;
      }
    return full ? static_cast<std::uint32_t>(sizeof(Node)) - node_bytes(accel_, bvh_) : 0;
  }

  /// All that is reached from its root without leaving it is all that it has; the parent of each is in it, so it is
  /// connected; its bytes follow one another.
  void go_through(const TreePieces::Piece& piece) {
    const std::uint32_t number = cut_.index(piece.root);
    ASSERT_EQ(&cut_.pieces[number], &piece);
    std::uint32_t nodes = 0, leaves = 0, exits = 0, bytes = 0;
    std::vector<NodeRef> open{piece.root};
    while (!open.empty()) {
      const NodeRef ref = open.back();
      open.pop_back();
      EXPECT_GE(cut_.address(ref), piece.address);
      EXPECT_LE(cut_.address(ref) + bytes_of(ref), piece.address + piece.bytes);
      bytes += bytes_of(ref);
      ++(ref.is_inner() ? nodes : leaves);
      if (!ref.is_inner()) continue;
      ++seen_nodes_[ref.node()];
      const Node& node = accel_.nodes[ref.node()];
      for (int lane = 0; lane < node.count; ++lane) {
        if ((node.direct >> lane & 1) != 0) continue;
        const NodeRef child = node.child[lane];
        const NodeRef root = child.is_instance() ? NodeRef() : cut_.piece(child).root;
        if (cut_.together(ref, child)) {
          EXPECT_NE(root, child) << "a piece is entered at its root alone";
          open.push_back(child);
        } else {
          ++exits;
          if (!child.is_instance()) {
            EXPECT_EQ(root, child);
          }
        }
      }
    }
    EXPECT_EQ(nodes, piece.nodes);
    EXPECT_EQ(leaves, piece.leaves);
    EXPECT_EQ(exits, piece.exits);
    EXPECT_EQ(bytes, piece.bytes);
    EXPECT_LE(exits, cut_.most_exits);
    EXPECT_TRUE(bytes <= bvh_.treelets.bytes || nodes + leaves == 1) << bytes;
  }

  const Accel& accel_;
  const BvhConfig& bvh_;
  const TreePieces& cut_;
  std::vector<bool> reached_ = std::vector<bool>(accel_.nodes.size());
  std::vector<int> seen_nodes_ = std::vector<int>(accel_.nodes.size());
};

std::vector<scene::Scene> scenes() {
  std::vector<scene::Scene> out;
  out.push_back(small_builtin(BuiltinScene::kTerrain, 3000));
  out.push_back(small_builtin(BuiltinScene::kCornell));
  out.push_back(small_builtin(BuiltinScene::kInstances, 300, 40));
  out.push_back(small_builtin(BuiltinScene::kInstances, 300, 60, 4));
  out.push_back(empty_scene());
  return out;
}

/// Every structure that a key can make of a scene, cut.
template <class Check>
void for_each_cut(const Check& check) {
  const auto executor = make_sequential_executor();
  using enum BvhConfig::Storage;
  for (const scene::Scene& scene : scenes())
    for (const auto storage : {kFull, kQuantised})
      for (const int variant : {0, 1, 2})
        for (const int bytes : {1, 300, 1024, 4096, 1 << 20}) {
          BvhConfig bvh;
          bvh.storage = storage;
          bvh.treelets.bytes = bytes;
          if (variant == 1) bvh.width = 4, bvh.levels = 4, bvh.mixed_triangles = 4;
          if (variant == 2) bvh.merge = BvhConfig::Merge::kWorld, bvh.leaf_triangles = 1;
          SCOPED_TRACE(testing::Message()
                       << bytes << " bytes, variant " << variant << ", storage " << enum_name(storage));
          check(scene, bvh, *executor);
        }
}

TEST(TreeCut, HasEveryNodeInOneConnectedPieceOfAtMostTheBytes) {
  for_each_cut([](const scene::Scene& scene, const BvhConfig& bvh, Executor& executor) {
    const Accel accel = build(scene, bvh, executor);
    ASSERT_NE(accel.pieces, nullptr);
    CutCheck(accel, bvh).check();
  });
}

TEST(TreeCut, IsTheSameEachTime) {
  for_each_cut([](const scene::Scene& scene, const BvhConfig& bvh, Executor& executor) {
    const Accel a = build(scene, bvh, executor), b = build(scene, bvh, executor);
    EXPECT_EQ(a.pieces->of_node, b.pieces->of_node);
    EXPECT_EQ(a.pieces->of_leaf, b.pieces->of_leaf);
    EXPECT_EQ(a.pieces->node_at, b.pieces->node_at);
    EXPECT_EQ(a.pieces->leaf_at, b.pieces->leaf_at);
  });
}

// A mesh that fits as a whole is one piece, and so is the top level.
TEST(TreeCut, IsAPieceAStructureWhereThatFits) {
  const auto executor = make_sequential_executor();
  BvhConfig bvh;
  bvh.treelets.bytes = 1 << 20;
  const Accel accel = build(small_builtin(BuiltinScene::kInstances, 300, 40), bvh, *executor);
  std::size_t meshes = 0;
  std::vector<NodeRef> roots;
  for (const InstanceNode& instance : accel.instances)
    if (std::find(roots.begin(), roots.end(), instance.root) == roots.end()) {
      roots.push_back(instance.root);
      ++meshes;
    }
  EXPECT_EQ(accel.pieces->pieces.size(), meshes + 1) << "and one of the top level";
  EXPECT_EQ(accel.pieces->depth, 2);
}

double half_area(const Node& node, int lane) {
  double e[3];
  for (int axis = 0; axis < 3; ++axis) e[axis] = node.plane[axis + 3][lane] - node.plane[axis][lane];
  return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/// The areas of the roots of all pieces but the first, which the cut makes small: rays come to a piece by its root's
/// area. `together(parent, child)`: both are in one piece. Nodes to which no ray comes do not count.
template <class Together>
double area_of_roots(const Accel& accel, const Together& together) {
  double area = 0;
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) {
    const Node& node = accel.nodes[n];
    for (int lane = 0; accel.pieces->holds(NodeRef::inner(n)) && lane < node.count; ++lane)
      if (!together(NodeRef::inner(n), node.child[lane])) area += half_area(node, lane);
  }
  return area;
}
double area_of_roots(const Accel& accel) {
  return area_of_roots(accel, [&](NodeRef parent, NodeRef child) { return accel.pieces->together(parent, child); });
}

/// The same of pieces that take nodes in depth-first order, each as long as it fits. Full nodes, one mesh.
double area_of_depth_first_roots(const Accel& accel, const BvhConfig& bvh) {
  struct Entry {
    NodeRef ref;
    double area = 0;
  };
  double area = 0;
  std::vector<NodeRef> roots{accel.root_key().ref};
  while (!roots.empty()) {
    std::vector<Entry> open{{roots.back()}};
    roots.pop_back();
    std::int64_t left = bvh.treelets.bytes;
    for (bool first = true; !open.empty(); first = false) {
      const Entry entry = open.back();
      open.pop_back();
      const bool inner = entry.ref.is_inner();
      const std::int64_t bytes = inner ? node_bytes(accel, bvh) : leaf_bytes(entry.ref, bvh.storage);
      if (!first && bytes > left) {
        area += entry.area;
        roots.push_back(entry.ref);
        continue;
      }
      left -= bytes;
      if (!inner) continue;
      const Node& node = accel.nodes[entry.ref.node()];
      for (int lane = node.count; lane-- > 0;) open.push_back({node.child[lane], half_area(node, lane)});
    }
  }
  return area;
}

// Larger pieces are entered less, and pieces that grow by area less than those that take whatever comes first.
TEST(TreeCut, LargerPiecesAreEnteredLess) {
  const auto executor = make_sequential_executor();
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 3000);
  struct Row {
    int bytes;
    double of_smaller, of_depth_first;  // measured: 0.61, 0.49, 0.91 and 0.83, 0.64, 0.96
  };
  double before = 0;
  for (const Row& row : {Row{1, 1, 1}, Row{1024, 0.65, 0.86}, Row{4096, 0.53, 0.68}, Row{16384, 0.94, 0.98}}) {
    BvhConfig bvh;
    bvh.treelets.bytes = row.bytes;
    const Accel accel = build(scene, bvh, *executor);
    const double area = area_of_roots(accel), simple = area_of_depth_first_roots(accel, bvh);
    if (row.bytes == 1) {  // every node and leaf is a piece
      before = area_of_roots(accel, [](NodeRef, NodeRef) { return false; });
      EXPECT_GT(before, 0);
      EXPECT_DOUBLE_EQ(area, before);
      EXPECT_NEAR(simple, before, 1e-9 * before);
    } else {
      EXPECT_LT(area, row.of_smaller * before) << row.bytes;
      EXPECT_LT(area, row.of_depth_first * simple) << row.bytes;
      before = area;
    }
  }
}

// By hand: a root with two leaves of area, the larger one of which fits besides it. Nodes take 256 bytes, leaves of a
// block 160.
TEST(TreeCut, GrowsByTheMostAreaForItsBytes) {
  const auto executor = make_sequential_executor();
  BvhConfig bvh;
  bvh.width = 2;
  bvh.leaf_triangles = 1;
  bvh.treelets.bytes = 256 + 160;
  const Accel accel =
      build(scene_of(soup({{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {20, 0, 0}, {21, 0, 0}, {20, 1, 0}})), bvh, *executor);
  const NodeRef root = accel.instances[0].root;
  ASSERT_TRUE(root.is_inner());
  const Node& node = accel.nodes[root.node()];
  ASSERT_EQ(node.count, 2);
  const int large = node.plane[3][0] - node.plane[0][0] > node.plane[3][1] - node.plane[0][1] ? 0 : 1;
  EXPECT_TRUE(accel.pieces->together(root, node.child[large]));
  EXPECT_FALSE(accel.pieces->together(root, node.child[1 - large]));
}

}  // namespace
}  // namespace carousel::accel
