#include "accel/builders/binary/reinsertion.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace carousel::accel {

namespace {

constexpr int kDeepest = 72;  // levels below the root; a traversal stack has room for so many (stack-inl.h)
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

Aabb joined(Aabb a, const Aabb& b) {
  a.extend(b);
  return a;
}

class Reinsertion {
 public:
  Reinsertion(BinaryTree& nodes, Executor& executor)
      : nodes_(nodes), executor_(executor), parent_(nodes.size(), kNone) {
    walk();
  }

  void run() {
    constexpr int kRounds = 4;
    constexpr double kEnough = 0.001;  // a round must gain this part of the whole area
    const int deepest = std::max(kDeepest, depth_);
    double area = sum();
    for (int i = 0; i < kRounds; ++i) {
      const BinaryTree before = nodes_;
      const std::vector<Move> moves = best_moves();
      if (moves.empty()) return;
      make(moves);
      if (!(area - sum() >= 0.9 * static_cast<double>(moves.front().gain))) {  // one's gain was another's loss
        nodes_ = before;
        walk();
        make(std::span(moves).first(1));
      }
      const double now = sum();
      if (depth_ > deepest) {
        nodes_ = before;
        return;
      }
      if (!(now < area * (1 - kEnough))) return;
      area = now;
    }
  }

 private:
  /// A subtree, and the node that it would become the sibling of.
  struct Move {
    std::uint32_t from = kNone, to = kNone;
    float gain = 0;
  };

  bool leaf(std::uint32_t at) const { return nodes_[at].count > 0; }
  std::uint32_t sibling(std::uint32_t at) const {
    const BinaryNode& parent = nodes_[parent_[at]];
    return parent.first == at ? parent.right : parent.first;
  }

  /// Notes parents, and the nodes that are in the tree, each behind its parent; not every place holds one.
  void walk() {
    used_.clear();
    depth_ = 0;
    std::vector<std::pair<std::uint32_t, int>> open{{0, 0}};
    while (!open.empty()) {
      const auto [at, depth] = open.back();
      open.pop_back();
      used_.push_back(at);
      depth_ = std::max(depth_, depth);
      if (leaf(at)) continue;
      for (const std::uint32_t child : {nodes_[at].first, nodes_[at].right}) {
        parent_[child] = at;
        open.emplace_back(child, depth + 1);
      }
    }
  }

  double sum() const {
    double out = 0;
    for (const std::uint32_t at : used_)
      if (!leaf(at)) out += nodes_[at].box.half_area();
    return out;
  }

  /// The best place for a subtree: upwards from where it is, beside each ancestor, and down into its other side. A
  /// branch is left where even a place that costs no more than the subtree's own area would gain no more than the best
  /// so far.
  Move best(std::uint32_t from, std::vector<std::pair<float, std::uint32_t>>& open) const {
    Move out{from, kNone, 0};
    const Aabb& box = nodes_[from].box;
    const float own = box.half_area();
    std::uint32_t pivot = parent_[from];
    const std::uint32_t old_sibling = sibling(from);
    // The area gained so far: the parent goes, and ancestors that the subtree leaves shrink to `rest`.
    float saved = nodes_[pivot].box.half_area();
    Aabb rest = nodes_[old_sibling].box;
    std::uint32_t side = old_sibling;
    while (true) {
      open.clear();
      open.emplace_back(saved, side);
      while (!open.empty()) {
        const auto [bound, at] = open.back();
        open.pop_back();
        if (bound - own <= out.gain) continue;
        const float together = joined(nodes_[at].box, box).half_area();
        const float gain = bound - together;
        if (gain > out.gain && at != old_sibling) out = {from, at, gain};
        if (leaf(at)) continue;
        const float below = gain + nodes_[at].box.half_area();
        if (below - own <= out.gain) continue;
        open.emplace_back(below, nodes_[at].first);
        open.emplace_back(below, nodes_[at].right);
      }
      if (pivot != parent_[from]) {
        rest.extend(nodes_[side].box);
        saved += nodes_[pivot].box.half_area() - rest.half_area();
        const float gain = saved - nodes_[pivot].box.half_area();  // beside this ancestor
        if (gain > out.gain && parent_[pivot] != kNone) out = {from, pivot, gain};
      }
      if (parent_[pivot] == kNone) return out;
      side = sibling(pivot);
      pivot = parent_[pivot];
    }
  }

  /// The best move of each subtree that has one, the greatest gain first.
  std::vector<Move> best_moves() const {
    std::vector<Move> moves(used_.size());
    executor_.parallel_for(used_.size(), 1 << 8, [&](std::size_t begin, std::size_t end) {
      std::vector<std::pair<float, std::uint32_t>> open;
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t at = used_[i];
        if (at != 0 && parent_[at] != 0) moves[i] = best(at, open);
      }
    });
    std::erase_if(moves, [](const Move& m) { return !(m.gain > 0); });
    std::sort(moves.begin(), moves.end(),
              [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.from < b.from; });
    return moves;
  }

  /// A move whose nodes another has changed is left out.
  void make(std::span<const Move> moves) {
    std::vector<std::uint8_t> taken(nodes_.size());
    for (const Move& m : moves) {
      const std::uint32_t parent = parent_[m.from];
      const std::uint32_t touched[] = {m.from, sibling(m.from), parent, parent_[parent], m.to, parent_[m.to]};
      if (std::any_of(std::begin(touched), std::end(touched), [&](std::uint32_t at) { return taken[at] != 0; }))
        continue;
      // By exact areas no two subtrees are best off within each other: of each two the larger would stay outside.
      if (below(m.to, m.from)) continue;
      for (const std::uint32_t at : touched) taken[at] = 1;
      move(m);
    }
    refit();
  }

  bool below(std::uint32_t at, std::uint32_t top) const {
    while (at != top && at != kNone) at = parent_[at];
    return at == top;
  }

  void move(const Move& m) {
    const std::uint32_t parent = parent_[m.from], other = sibling(m.from), above = parent_[parent], at = parent_[m.to];
    replace(above, parent, other);
    replace(at, m.to, parent);
    nodes_[parent].first = m.to;
    nodes_[parent].right = m.from;
    parent_[m.to] = parent;
  }
  void replace(std::uint32_t parent, std::uint32_t old, std::uint32_t now) {
    (nodes_[parent].first == old ? nodes_[parent].first : nodes_[parent].right) = now;
    parent_[now] = parent;
  }

  void refit() {
    walk();
    for (std::size_t i = used_.size(); i-- > 0;) {
      BinaryNode& node = nodes_[used_[i]];
      if (node.count == 0) node.box = joined(nodes_[node.first].box, nodes_[node.right].box);
    }
  }

  BinaryTree& nodes_;
  Executor& executor_;
  std::vector<std::uint32_t> parent_, used_;
  int depth_ = 0;
};

}  // namespace

void reinsert(BinaryTree& nodes, Executor& executor) {
  if (nodes.size() > 4) Reinsertion(nodes, executor).run();
}

}  // namespace carousel::accel
