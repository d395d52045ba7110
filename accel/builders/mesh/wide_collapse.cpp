#include "accel/builders/mesh/wide_collapse.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>

namespace carousel::accel {

namespace {

constexpr int kTaskDepth = 2;                  // depth of the wide nodes whose subtrees are tasks
constexpr int kPriceTaskDepth = 8;             // binary nodes above this depth are priced by tasks
constexpr std::size_t kDividedTree = 1 << 15;  // places of the smallest tree that is divided into tasks

std::uint32_t saturating_add(std::uint32_t a, std::uint32_t b) {
  return a > 0xffffffffu - b ? 0xffffffffu : a + b;
}

class Collapse {
 public:
  Collapse(const BinaryTree& binary, int width, const MakeLeaf& make_leaf, Executor& executor, NodeArray& nodes,
           std::vector<BlockRun>* runs)
      : binary_(binary),
        width_(width),
        make_leaf_(make_leaf),
        executor_(executor),
        nodes_(nodes),
        runs_(runs),
        divided_(runs != nullptr && binary.size() >= kDividedTree),
        shares_(std::make_unique_for_overwrite<Shares[]>(binary.size())) {}

  WideTree run() {
    price(0, 0);
    find_tasks(0, 0);
    each_task([&](Task& task) { count(task.root, task); });
    const std::uint32_t first_node = static_cast<std::uint32_t>(nodes_.size());
    next_node_ = first_node;
    number(0, 0);
    nodes_.grow(next_node_);
    each_task([&](Task& task) {
      task.blocks.reserve(task.block_count);
      std::uint32_t next = task.first_node;
      task.tree = emit(task.root, next, task);
    });
    next_node_ = first_node;
    next_block_ = 0;
    next_task_ = 0;
    const WideTree tree = emit_above(0, 0);
    if (runs_ != nullptr)
      for (Task& task : tasks_) runs_->push_back({task.first_block, std::move(task.blocks)});
    return tree;
  }

 private:
  /// [i]: the least area of wide nodes that a subtree needs when its parent has i + 1 places for it.
  using Prices = std::array<float, kMaxWidth>;
  /// [i]: of i + 1 places, those that go to the left child; kWhole when one place does as well.
  using Shares = std::array<std::uint8_t, kMaxWidth>;
  static constexpr std::uint8_t kWhole = 0;

  /// A subtree that one thread turns into nodes, whose numbers and blocks' numbers are consecutive.
  struct Task {
    std::uint32_t root = 0;
    std::uint32_t node_count = 0, block_count = 0;
    std::uint32_t first_node = 0, first_block = 0;
    std::vector<BlockPrimitives> blocks;
    WideTree tree;
  };

  Prices price(std::uint32_t at, int depth) {
    Prices prices{};
    const BinaryNode& node = binary_[at];
    if (node.count > 0) return prices;  // a leaf costs the same wherever it hangs
    Prices left, right;
    if (divided_ && depth < kPriceTaskDepth) {
      executor_.invoke([&] { left = price(node.first, depth + 1); }, [&] { right = price(node.right, depth + 1); });
    } else {
      left = price(node.first, depth + 1);
      right = price(node.right, depth + 1);
    }
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

  std::uint32_t blocks_of(std::uint32_t leaf) const {
    return runs_ == nullptr ? 0 : (binary_[leaf].count + kBlockTriangles - 1) / kBlockTriangles;
  }
  WideTree leaf(std::uint32_t at, std::uint32_t first_block, std::vector<BlockPrimitives>& blocks) const {
    const BinaryNode& node = binary_[at];
    for (std::uint32_t i = 0; i < blocks_of(at); ++i) {
      const std::uint32_t before = i * kBlockTriangles;
      blocks.push_back({node.first + before, std::min<std::uint32_t>(kBlockTriangles, node.count - before)});
    }
    const WideLeaf made = make_leaf_(node, first_block);
    return {made.ref, made.strip_size, made.triangles, made.ref.is_instance() ? 0 : 1};
  }

  /// Visits the binary nodes that become the children of a wide node.
  template <class Visit>
  void each_child(std::uint32_t at, const Visit& visit) const {
    Children children;
    open(at, width_, shares_[at][0], children);
    for (int lane = 0; lane < children.count; ++lane) visit(children.nodes[static_cast<std::size_t>(lane)]);
  }

  /// Makes the node of number `index`; `emit` turns a binary node into a child.
  template <class Emit>
  WideTree make_node(std::uint32_t at, std::uint32_t index, const Emit& emit) const {
    Node node;
    int depth = 0;
    each_child(at, [&](std::uint32_t below) {
      const WideTree child = emit(below);
      const Aabb& box = binary_[below].box;
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[axis][node.count] = box.lo[axis];
        node.plane[axis + 3][node.count] = box.hi[axis];
      }
      node.child[node.count] = child.root;
      node.strip_size[node.count] = child.root_strip_size;
      node.triangles = saturating_add(node.triangles, child.triangles);
      depth = std::max(depth, child.depth);
      ++node.count;
    });
    nodes_[index] = node;
    return {NodeRef::inner(index), node.count, node.triangles, depth + 1};
  }

  WideTree emit(std::uint32_t at, std::uint32_t& next_node, Task& out) const {
    if (binary_[at].count > 0)
      return leaf(at, out.first_block + static_cast<std::uint32_t>(out.blocks.size()), out.blocks);
    const std::uint32_t index = next_node++;
    return make_node(at, index, [&](std::uint32_t below) { return emit(below, next_node, out); });
  }

  void count(std::uint32_t at, Task& out) const {
    if (binary_[at].count > 0) {
      out.block_count += blocks_of(at);
      return;
    }
    ++out.node_count;
    each_child(at, [&](std::uint32_t below) { count(below, out); });
  }

  bool is_task(int depth) const { return depth == (divided_ ? kTaskDepth : 0); }

  void find_tasks(std::uint32_t at, int depth) {
    if (binary_[at].count > 0) return;
    if (is_task(depth))
      tasks_.emplace_back().root = at;
    else
      each_child(at, [&](std::uint32_t below) { find_tasks(below, depth + 1); });
  }
  template <class Body>
  void each_task(const Body& body) {
    executor_.parallel_for(tasks_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(tasks_[i]);
    });
  }

  /// Gives the tasks' nodes and blocks their numbers, in the order in which emit_above() passes them.
  void number(std::uint32_t at, int depth) {
    if (binary_[at].count > 0) {
      next_block_ += blocks_of(at);
    } else if (is_task(depth)) {
      Task& task = tasks_[next_task_++];
      task.first_node = next_node_;
      task.first_block = next_block_;
      pass(task);
    } else {
      ++next_node_;
      each_child(at, [&](std::uint32_t below) { number(below, depth + 1); });
    }
  }
  void pass(const Task& task) {
    next_node_ += task.node_count;
    next_block_ += task.block_count;
  }

  /// Makes the nodes above the tasks.
  WideTree emit_above(std::uint32_t at, int depth) {
    if (binary_[at].count > 0) {
      BlockRun run{next_block_, {}};
      const WideTree tree = leaf(at, next_block_, run.blocks);
      next_block_ += blocks_of(at);
      if (runs_ != nullptr) runs_->push_back(std::move(run));
      return tree;
    }
    if (is_task(depth)) {
      const Task& task = tasks_[next_task_++];
      pass(task);
      return task.tree;
    }
    const std::uint32_t index = next_node_++;
    return make_node(at, index, [&](std::uint32_t below) { return emit_above(below, depth + 1); });
  }

  const BinaryTree& binary_;
  int width_;
  const MakeLeaf& make_leaf_;
  Executor& executor_;
  NodeArray& nodes_;
  std::vector<BlockRun>* runs_;  // null: leaves have no blocks
  bool divided_;
  std::unique_ptr<Shares[]> shares_;  // by binary node
  std::vector<Task> tasks_;           // depth-first
  std::size_t next_task_ = 0;
  std::uint32_t next_node_ = 0, next_block_ = 0;
};

}  // namespace

WideTree collapse(const BinaryTree& binary, int width, const MakeLeaf& make_leaf, Executor& executor, NodeArray& nodes,
                  std::vector<BlockRun>* runs) {
  return Collapse(binary, width, make_leaf, executor, nodes, runs).run();
}

}  // namespace carousel::accel
