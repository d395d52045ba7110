#include "accel/builders/deal.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace carousel::accel {

namespace {

/// Half of a box's surface, in double, so that the same sums come out anywhere.
double area_of(const Aabb& box) {
  const double x = double{box.hi.x} - double{box.lo.x}, y = double{box.hi.y} - double{box.lo.y},
               z = double{box.hi.z} - double{box.lo.z};
  return x * y + y * z + z * x;
}

/// 1 and the logarithm of a number to the base 2, in straight lines between powers of two: so it is exact in double.
double levels_of(std::size_t items) {
  const int whole = std::bit_width(items) - 1;
  return whole + static_cast<double>(items) / static_cast<double>(std::size_t{1} << whole);
}

class Dealer {
 public:
  Dealer(std::span<const DealtNode> tree, std::vector<DealtItem>& items)
      : tree_(tree), items_(items), out_(items.size()), first_place_(tree.size()) {}

  std::uint64_t run() {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      first_place_[i] = next;
      if (tree_[i].children.empty()) next += tree_[i].items;
    }
    node(0, 0);
    items_ = std::move(out_);
    return boxes_;
  }

 private:
  void node(std::uint32_t at, std::size_t first) {
    const DealtNode& node = tree_[at];
    if (!node.children.empty()) return part(node.children, first);
    std::copy_n(items_.begin() + static_cast<std::ptrdiff_t>(first), node.items,
                out_.begin() + static_cast<std::ptrdiff_t>(first_place_[at]));
  }

  /// Gives the items from number `first` on to some children of a node, as many as they hold.
  void part(const std::vector<std::uint32_t>& children, std::size_t first) {
    if (children.size() == 1) return node(children[0], first);
    std::size_t count = 0;
    for (const std::uint32_t child : children) count += tree_[child].items;
    const Parting best = best_of(children, first, count);
    sort(best.axis, first, count);
    std::vector<std::uint32_t> one, other;
    for (std::size_t i = 0; i < children.size(); ++i) ((best.set >> i & 1) != 0 ? one : other).push_back(children[i]);
    part(one, first);
    part(other, first + items_of(children, best.set));
  }

  struct Parting {
    int axis = 0;
    std::uint32_t set = 1;  // of children that get the first items
  };

  std::size_t items_of(const std::vector<std::uint32_t>& children, std::uint32_t set) const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < children.size(); ++i) sum += (set >> i & 1) != 0 ? tree_[children[i]].items : 0;
    return sum;
  }

  Parting best_of(const std::vector<std::uint32_t>& children, std::size_t first, std::size_t count) {
    Parting best;
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      sort(axis, first, count);
      cost_.assign(count, 0);  // of a parting behind so many items
      Aabb box;
      for (std::size_t i = count; i-- > 1;) {
        box.extend(items_[first + i].box);
        cost_[i] = area_of(box) * levels_of(count - i);
      }
      box = {};
      for (std::size_t i = 1; i < count; ++i) {
        box.extend(items_[first + i - 1].box);
        cost_[i] = area_of(box) * levels_of(i) + cost_[i];
      }
      for (std::uint32_t set = 1; set + 1 < 1u << children.size(); ++set) {
        const double cost = cost_[items_of(children, set)];
        if (!(cost < least)) continue;
        least = cost;
        best = {axis, set};
      }
    }
    boxes_ += 2 * count;
    return best;
  }

  void sort(int axis, std::size_t first, std::size_t count) {
    const auto middle = [&](const DealtItem& item) { return double{item.box.lo[axis]} + double{item.box.hi[axis]}; };
    const auto begin = items_.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, begin + static_cast<std::ptrdiff_t>(count), [&](const DealtItem& a, const DealtItem& b) {
      return std::pair(middle(a), a.id) < std::pair(middle(b), b.id);
    });
  }

  std::span<const DealtNode> tree_;
  std::vector<DealtItem>& items_;
  std::vector<DealtItem> out_;
  std::vector<std::uint32_t> first_place_;  // by node: items before it, depth first
  std::vector<double> cost_;                // scratch
  std::uint64_t boxes_ = 0;
};

}  // namespace

std::uint64_t deal(std::span<const DealtNode> tree, std::vector<DealtItem>& items) {
  return Dealer(tree, items).run();
}

double dealt_area(std::span<const DealtNode> tree, std::span<const DealtItem> items, std::uint32_t block) {
  // Children stand behind their parents, depth first, so that the last place has the last items.
  std::vector<Aabb> boxes(tree.size());
  double sum = 0;
  std::size_t end = items.size();
  for (std::size_t i = tree.size(); i-- > 0;) {
    const DealtNode& node = tree[i];
    for (const std::uint32_t child : node.children) boxes[i].extend(boxes[child]);
    if (node.children.empty()) {
      for (std::uint32_t k = 0; k < node.items; ++k) boxes[i].extend(items[--end].box);
    }
    if (i == 0) break;
    const std::uint32_t parts = node.children.empty() ? (node.items + block - 1) / block : 1;
    sum += area_of(boxes[i]) * parts;
  }
  return sum;
}

}  // namespace carousel::accel
