#include "accel/builders/quantised_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Planes of one axis: `lo` and `hi` of `count` children, at most `steps` from the origin. In doubles the products and
/// sums are exact but for planes that lie farther from the origin than 2^29 steps' bits, and these are rounded outwards
/// as well.
void quantise_axis(float* lo, float* hi, int count, int steps) {
  float origin = kInfinity, end = -kInfinity;
  for (int lane = 0; lane < count; ++lane) {
    origin = std::min(origin, lo[lane]);
    end = std::max(end, hi[lane]);
  }
  if (!std::isfinite(origin) || !std::isfinite(end) || end < origin) return;
  const double base = origin, length = static_cast<double>(end) - base;
  int exponent = length > 0 ? std::ilogb(length / steps) : 0;
  while (std::ldexp(static_cast<double>(steps), exponent) < length) ++exponent;
  const double step = std::ldexp(1.0, exponent);
  for (int lane = 0; lane < count; ++lane) {
    int low = std::clamp(static_cast<int>(std::floor((lo[lane] - base) / step)), 0, steps);
    int high = std::clamp(static_cast<int>(std::ceil((hi[lane] - base) / step)), 0, steps);
    while (low > 0 && base + low * step > lo[lane]) --low;
    while (high < steps && base + high * step < hi[lane]) ++high;
    lo[lane] = std::min(lo[lane], rounded_down(base + low * step));
    hi[lane] = std::max(hi[lane], rounded_up(base + high * step));
  }
}

void quantise(Node& node, int steps) {
  for (int axis = 0; axis < 3; ++axis) quantise_axis(node.plane[axis], node.plane[axis + 3], node.count, steps);
}

/// True if a hit has to lie in the world box of a child of the top level's node, and no other test sees to that.
bool holds_world_boxes(const Accel& accel, const Node& node) {
  return std::any_of(node.child, node.child + node.count, [&](NodeRef child) {
    if (!child.is_instance()) return false;
    const InstanceNode& instance = accel.instances[child.instance_index()];
    return !instance.transform.identity && !instance.group;
  });
}

}  // namespace

std::vector<std::uint32_t> unquantised_nodes(const Accel& accel) {
  std::vector<std::uint32_t> out;
  const NodeKey root = accel.root_key();
  if (root.instance != kNoInstance || !root.ref.is_inner()) return out;
  std::vector<std::uint32_t> open{root.ref.node()};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    const Node& node = accel.nodes[at];
    if (!node.above_instances) continue;  // the nodes of merged meshes hold no world boxes
    if (holds_world_boxes(accel, node)) out.push_back(at);
    for (int lane = 0; lane < node.count; ++lane)
      if (node.child[lane].is_inner()) open.push_back(node.child[lane].node());
  }
  return out;
}

void quantise_boxes(Accel& accel, int bits) {
  accel.full_nodes = accel.nodes;
  for (Node& node : accel.nodes) quantise(node, (1 << bits) - 1);
  for (const std::uint32_t node : unquantised_nodes(accel)) accel.nodes[node] = accel.full_nodes[node];
}

}  // namespace carousel::accel
