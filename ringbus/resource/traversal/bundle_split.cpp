#include "ringbus/resource/traversal/bundle_split.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "accel/structure/cull_plane.h"

namespace carousel::ringbus {

namespace {

// The largest extent, along an axis, of the node's children together.
float extent_of_children(const accel::Node& node) {
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float lo = *std::min_element(node.plane[axis], node.plane[axis] + node.count);
    const float hi = *std::max_element(node.plane[axis + 3], node.plane[axis + 3] + node.count);
    largest = std::max(largest, hi - lo);
  }
  return largest;
}

}  // namespace

BundleSplitRule::BundleSplitRule(const BundlesConfig& config, const accel::Accel& accel, float scene_size)
    : accel_(accel),
      below_(config.split_below),
      above_(config.split_above),
      at_instances_(config.at_instances == BundlesConfig::AtInstances::kSplit),
      smallest_box_(static_cast<float>(config.split_below.box_size) * scene_size) {}

bool BundleSplitRule::in_model_space(accel::NodeKey key) const {
  return key.instance != kNoInstance && !accel_.instances[key.instance].transform.identity;
}

bool BundleSplitRule::at_node(accel::NodeKey key, std::uint16_t depth) const {
  if (depth > below_.depth) return true;
  if (at_instances_ && in_model_space(key)) return true;
  const accel::Node& node = accel_.nodes[key.ref.node()];
  return smallest_box_ > 0 && node.count > 0 && extent_of_children(node) < smallest_box_;
}

bool BundleSplitRule::too_wide(const accel::BundleRecord& bundle, const accel::Node& node) const {
  const auto& [spread, silhouette_area] = above_;
  if ((spread <= 0 && silhouette_area <= 0) || node.count == 0) return false;
  Aabb box;
  for (int lane = 0; lane < node.count; ++lane) box.extend(accel::child_box(node, lane));
  double longest = 0, range = 0, length2 = 0, distance2 = 0;
  std::array<double, 3> from{}, across{};
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = bundle.direction_min[axis], hi = bundle.direction_max[axis], middle = 0.5 * (lo + hi);
    longest = std::max({longest, std::fabs(lo), std::fabs(hi)});
    across[static_cast<std::size_t>(axis)] = hi - lo;
    range = std::max(range, hi - lo);
    from[static_cast<std::size_t>(axis)] = double{bundle.origin_max[axis]} - bundle.origin_min[axis];
    const double way = double{box.centre()[axis]} - 0.5 * (double{bundle.origin_min[axis]} + bundle.origin_max[axis]);
    length2 += middle * middle;
    distance2 += way * way;
  }
  if (spread > 0 && range > spread * longest) return true;
  if (!(silhouette_area > 0) || !(length2 > 0)) return false;
  const double t = std::sqrt(distance2 / length2);
  std::array<double, 3> wide{};
  for (std::size_t axis = 0; axis < 3; ++axis) wide[axis] = from[axis] + t * across[axis];
  std::sort(wide.begin(), wide.end());
  return wide[1] * wide[2] > silhouette_area * box.half_area() / 3;
}

}  // namespace carousel::ringbus
