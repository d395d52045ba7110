#include "accel/traverse/oracle_tree.h"

#include <algorithm>
#include <numeric>

namespace carousel::accel {

void OracleTree::build(std::span<const Aabb> boxes) {
  if (boxes.empty()) return;
  struct Open {
    std::uint32_t node, begin, end;
  };
  const auto all = static_cast<std::uint32_t>(boxes.size());
  std::vector<std::uint32_t> order(all);  // places in `boxes`
  std::iota(order.begin(), order.end(), 0u);
  nodes_.emplace_back();
  std::vector<Open> open{{0, 0, all}};
  while (!open.empty()) {
    const auto [index, begin, end] = open.back();
    open.pop_back();
    Aabb box, centres;
    for (std::uint32_t i = begin; i < end; ++i) {
      box.extend(boxes[order[i]]);
      centres.extend(boxes[order[i]].centre());
    }
    if (end - begin <= kLeafItems) {
      nodes_[index] = {box, begin, end - begin};
      continue;
    }
    const Vec3 extent = centres.extent();
    int axis = extent.y > extent.x ? 1 : 0;
    if (extent.z > extent[axis]) axis = 2;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        order.begin() + begin, order.begin() + middle, order.begin() + end,
        [&](std::uint32_t a, std::uint32_t b) { return boxes[a].centre()[axis] < boxes[b].centre()[axis]; });
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index] = {box, first, 0};
    nodes_.resize(nodes_.size() + 2);
    open.push_back({first, begin, middle});
    open.push_back({first + 1, middle, end});
  }
  std::vector<std::uint32_t> sorted(all);
  for (std::uint32_t i = 0; i < all; ++i) sorted[i] = items_[order[i]];
  items_.swap(sorted);
}

}  // namespace carousel::accel
