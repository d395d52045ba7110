#include "accel/cut/tree_cut.h"

#include <algorithm>
#include <limits>

#include "accel/structure/shape_bytes.h"
#include "core/types/aabb.h"

namespace carousel::accel {

namespace {

constexpr std::uint32_t kNoItem = ~0u;

/// A node, or a leaf with a box of its own.
struct Item {
  NodeRef ref;
  std::uint32_t bytes = 0;
  std::uint32_t first_child = 0, children = 0;  // in TreeCut::children_
  std::uint32_t growth = 0;                     // items of the best piece with this root
  double area = 0;                              // half of its box's surface
  double subtree_bytes = 0;
  double cost = 0;  // of the best cut of all that is below
};

class TreeCut {
 public:
  TreeCut(const Accel& accel, const BvhConfig& bvh, std::span<const std::uint32_t> as_floats)
      : accel_(accel),
        bvh_(bvh),
        as_floats_(as_floats),
        most_(static_cast<std::uint32_t>(bvh.treelets.bytes)),
        leaf_(accel.blocks.size(), kNoItem) {}

  TreePieces run() {
    make_items();
    // Some root may have turned out to be a node of a structure as well, which then hands its rays over there.
    for (Item& item : items_) {
      const auto begin = children_.begin() + item.first_child;
      const auto end =
          std::stable_partition(begin, begin + item.children, [&](std::uint32_t child) { return !is_root_[child]; });
      item.children = static_cast<std::uint32_t>(end - begin);
    }
    for (const std::uint32_t root : roots_) plan(root);
    out_.of_node.assign(accel_.nodes.size(), TreePieces::kNowhere);
    out_.of_leaf.assign(accel_.blocks.size(), TreePieces::kNowhere);
    out_.node_at.assign(accel_.nodes.size(), 0);
    out_.leaf_at.assign(accel_.blocks.size(), 0);
    for (const std::uint32_t root : roots_) store(root);
    depths_.assign(out_.pieces.size(), 0);
    out_.depth = depth(accel_.root_key());
    return std::move(out_);
  }

 private:
  // ---- the tree as items

  std::uint32_t item_of(NodeRef ref) {
    if (ref.is_inner()) return ref.node();
    std::uint32_t& item = leaf_[ref.first_block()];
    if (item == kNoItem) {
      item = static_cast<std::uint32_t>(items_.size());
      items_.push_back({ref, leaf_bytes(ref, bvh_.storage)});
    }
    return item;
  }

  /// Goes from where rays start to all that they can come to.
  void make_items() {
    const std::uint32_t record = node_bytes(accel_, bvh_);
    for (std::uint32_t n = 0; n < accel_.nodes.size(); ++n)
      items_.push_back({NodeRef::inner(n), record + bytes_behind(accel_, accel_.nodes[n])});
    for (const std::uint32_t n : as_floats_) items_[n].bytes += static_cast<std::uint32_t>(sizeof(Node)) - record;
    enter(accel_.root_key());
    for (std::size_t i = 0; i < open_.size(); ++i) expand(open_[i]);
  }
  /// Rays come to `key` from another structure, or at first: it begins a piece.
  void enter(NodeKey key) {
    const std::uint32_t item = item_of(key.ref);
    grow_flags();
    if (is_root_[item]) return;
    is_root_[item] = true;
    roots_.push_back(item);
    if (key.ref.is_inner()) items_[item].area = area_of_children(key.ref.node());
    open(item, key);
  }
  void open(std::uint32_t item, NodeKey key) {
    if (!is_open_[item]) open_.push_back(key);
    is_open_[item] = true;
  }
  void grow_flags() {
    is_root_.resize(items_.size(), false);
    is_open_.resize(items_.size(), false);
  }
  void expand(NodeKey key) {
    if (!key.ref.is_inner()) return;
    const std::uint32_t n = key.ref.node();
    const Node& node = accel_.nodes[n];
    const auto first = static_cast<std::uint32_t>(children_.size());
    for (int lane = 0; lane < node.count; ++lane) {
      if ((node.direct >> lane & 1) != 0) continue;
      const NodeKey child = accel_.child_key(key, lane);
      if (node.child[lane].is_instance()) {
        enter(child);
        continue;
      }
      const std::uint32_t item = item_of(child.ref);
      grow_flags();
      items_[item].area = half_area(node, lane);
      children_.push_back(item);
      open(item, child);
    }
    items_[n].first_child = first;
    items_[n].children = static_cast<std::uint32_t>(children_.size()) - first;
  }

  static double half_area(const Node& node, int lane) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = node.plane[axis][lane];
      box.hi[axis] = node.plane[axis + 3][lane];
    }
    return box.half_area();
  }
  double area_of_children(std::uint32_t n) const {
    const Node& node = accel_.nodes[n];
    Aabb box;
    for (int lane = 0; lane < node.count; ++lane)
      for (int axis = 0; axis < 3; ++axis) {
        box.lo[axis] = std::min(box.lo[axis], node.plane[axis][lane]);
        box.hi[axis] = std::max(box.hi[axis], node.plane[axis + 3][lane]);
      }
    return box.half_area();
  }

  // ---- the best cut

  /// Finds the best piece at each node of the structure below `root`.
  void plan(std::uint32_t root) {
    order_.assign(1, root);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Item& item = items_[order_[i]];
      for (std::uint32_t c = 0; c < item.children; ++c) order_.push_back(children_[item.first_child + c]);
    }
    for (std::size_t i = order_.size(); i-- > 0;) {
      Item& item = items_[order_[i]];
      item.subtree_bytes = item.bytes;
      for (std::uint32_t c = 0; c < item.children; ++c)
        item.subtree_bytes += items_[children_[item.first_child + c]].subtree_bytes;
    }
    set_price(root);
    for (std::size_t i = order_.size(); i-- > 0;) choose(order_[i]);
  }

  /// The price of a piece for being one, which keeps pieces of little area from staying small: as the paper has it.
  void set_price(std::uint32_t root) { price_ = items_[root].area * most_ / (items_[root].subtree_bytes * 10); }

  /// Grows a piece from `root` and keeps the size at which all below costs the least.
  void choose(std::uint32_t root) {
    double best = std::numeric_limits<double>::infinity();
    grow(root, kNoItem, [&](std::uint32_t, std::uint32_t count) {
      double cost = items_[root].area + price_;
      for (const std::uint32_t item : cut_) cost += items_[item].cost;
      if (cost >= best) return;
      best = cost;
      items_[root].growth = count;
    });
    items_[root].cost = best;
  }

  /// Grows a piece from `root` to `most` items as far as its bytes permit: calls added(item, items so far).
  template <class Added>
  void grow(std::uint32_t root, std::uint32_t most, const Added& added) {
    cut_.assign(1, root);
    std::uint32_t left = std::max(most_, items_[root].bytes);
    for (std::uint32_t count = 0; count < most;) {
      std::size_t chosen = cut_.size();
      double best = -1;
      for (std::size_t i = 0; i < cut_.size(); ++i) {
        const Item& item = items_[cut_[i]];
        if (item.bytes > left) continue;
        const double score = (item.area + price_) / std::min<double>(item.subtree_bytes, left);
        if (!(score > best)) continue;
        best = score;
        chosen = i;
      }
      if (chosen == cut_.size()) return;
      const std::uint32_t taken = cut_[chosen];
      const Item& item = items_[taken];
      cut_.erase(cut_.begin() + static_cast<std::ptrdiff_t>(chosen));
      for (std::uint32_t c = 0; c < item.children; ++c) cut_.push_back(children_[item.first_child + c]);
      left -= item.bytes;
      added(taken, ++count);
    }
  }

  // ---- the pieces in memory

  /// Stores the pieces of the structure below `root`, each before those below it.
  void store(std::uint32_t root) {
    set_price(root);
    std::vector<std::uint32_t> open{root};
    while (!open.empty()) {
      const std::uint32_t item = open.back();
      open.pop_back();
      store_piece(item);
      open.insert(open.end(), cut_.rbegin(), cut_.rend());
    }
  }

  void store_piece(std::uint32_t root) {
    const auto number = static_cast<std::uint32_t>(out_.pieces.size());
    TreePieces::Piece piece;
    piece.root = items_[root].ref;
    piece.address = out_.bytes;
    grow(root, items_[root].growth, [&](std::uint32_t i, std::uint32_t) {
      const Item& item = items_[i];
      const std::uint64_t at = piece.address + piece.bytes;
      piece.bytes += item.bytes;
      if (item.ref.is_inner()) {
        out_.of_node[item.ref.node()] = number;
        out_.node_at[item.ref.node()] = at;
        ++piece.nodes;
        piece.exits += ways_out(item.ref.node());
      } else {
        out_.of_leaf[item.ref.first_block()] = number;
        out_.leaf_at[item.ref.first_block()] = at;
        ++piece.leaves;
      }
    });
    piece.exits += static_cast<std::uint32_t>(cut_.size());
    out_.bytes = (piece.address + piece.bytes + 63) / 64 * 64;
    out_.most_exits = std::max(out_.most_exits, piece.exits);
    out_.pieces.push_back(piece);
  }
  /// Children of a node that begin another structure.
  std::uint32_t ways_out(std::uint32_t n) {
    const Node& node = accel_.nodes[n];
    std::uint32_t out = 0;
    for (int lane = 0; lane < node.count; ++lane)
      if ((node.direct >> lane & 1) == 0) out += node.child[lane].is_instance() || is_root_[item_of(node.child[lane])];
    return out;
  }

  /// Pieces on the longest way down from the root of a piece. Placements of a group share what is below them.
  int depth(NodeKey root) {
    int& known = depths_[out_.index(root.ref)];
    if (known > 0) return known;
    int below = 0;
    std::vector<NodeKey> open{root};
    while (!open.empty()) {
      const NodeKey key = open.back();
      open.pop_back();
      if (!key.ref.is_inner()) continue;
      const Node& node = accel_.nodes[key.ref.node()];
      for (int lane = 0; lane < node.count; ++lane) {
        if ((node.direct >> lane & 1) != 0) continue;
        const NodeKey child = accel_.child_key(key, lane);
        if (out_.together(key.ref, node.child[lane]))
          open.push_back(child);
        else
          below = std::max(below, depth(child));
      }
    }
    return depths_[out_.index(root.ref)] = below + 1;
  }

  const Accel& accel_;
  const BvhConfig& bvh_;
  std::span<const std::uint32_t> as_floats_;
  std::uint32_t most_;
  std::vector<std::uint32_t> leaf_;  // item, by a leaf's first block
  std::vector<Item> items_;          // nodes first
  std::vector<std::uint32_t> children_, roots_;
  std::vector<bool> is_root_, is_open_;
  std::vector<NodeKey> open_;  // all that rays can come to, parents before children
  double price_ = 0;
  TreePieces out_;
  std::vector<int> depths_;                 // by piece; 0: not known yet
  std::vector<std::uint32_t> order_, cut_;  // scratch
};

}  // namespace

TreePieces cut_tree(const Accel& accel, const BvhConfig& bvh, std::span<const std::uint32_t> as_floats) {
  return TreeCut(accel, bvh, as_floats).run();
}

}  // namespace carousel::accel
