// Bundles at their owner (US 11308683): tested as one where all of their rays fare alike, and left to the rays where
// they do not. A ray holds one count for each bundle it is in, and a bundle one for each test it waits for, so that
// what stays together touches one record a visit instead of one a ray.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "accel/box/bundle_intersect.h"
#include "accel/structure/cull_plane.h"
#include "accel/traverse/kernels.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

namespace {

std::uint32_t bits(std::uint32_t mask) {
  return static_cast<std::uint32_t>(std::popcount(mask));
}

// The largest extent of the node's children together, along an axis.
float extent(const accel::Node& node) {
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float lo = *std::min_element(node.plane[axis], node.plane[axis] + node.count);
    const float hi = *std::max_element(node.plane[axis + 3], node.plane[axis + 3] + node.count);
    largest = std::max(largest, hi - lo);
  }
  return largest;
}

}  // namespace

/// Moves what gather_local() found of bundles to a list of its own.
void Resource::find_bundles() {
  local_bundles_.clear();
  bundle_changes_.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < local_slots_.size(); ++i) {
    if (store_.is_bundle(local_slots_[i])) {
      local_bundles_.push_back({local_slots_[i], local_members_[i]});
      continue;
    }
    local_slots_[kept] = local_slots_[i];
    local_members_[kept++] = local_members_[i];
  }
  local_slots_.resize(kept);
  local_members_.resize(kept);
}

/// Whether the key is below an instance with a transform.
bool Resource::moved(accel::NodeKey key) const {
  return key.instance != kNoInstance && !accel_.instances[key.instance].transform.identity;
}

/// Whether bundles are tested as such at the packet's node.
bool Resource::bundles_go_on(const Packet& packet) const {
  const accel::NodeKey key = packet.key;
  if (!key.ref.is_inner() || is_treelet(key) || packet.depth > settings_.bundles.split_below.depth) return false;
  if (moved(key) && settings_.bundles.at_instances == BundlesConfig::AtInstances::kSplit) return false;
  const accel::Node& node = accel_.nodes[key.ref.node()];
  if (split_below_ > 0 && node.count > 0 && extent(node) < split_below_) return false;
  // A bundle that waits for more tests than its record can count goes on as rays.
  return std::none_of(local_bundles_.begin(), local_bundles_.end(), [&](const LocalBundle& b) {
    return store_.bundle(b.slot).pending > std::numeric_limits<std::int16_t>::max() - accel::kMaxWidth;
  });
}

/// Whether a bundle, in the node's space, is to be split there by its spread or its silhouette's area: how large a box
/// its rays fill by the time they have come as far as the node's middle, seen from where they come.
bool Resource::too_wide(const accel::BundleRecord& bundle, const accel::Node& node) const {
  const auto& [spread, silhouette_area] = settings_.bundles.split_above;
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

/// The bounds of rays in the space of an instance, as the box tests there will see them.
void Resource::compute_bounds(std::span<const std::uint32_t> rays, std::uint32_t instance,
                              accel::BundleRecord& bundle) {
  for (const std::uint32_t slot : rays) {
    const RayRecord& record = store_.record(slot);
    bundle.widen(accel_.instances[instance].transform.to_model(record.ray), record.hit.t);
  }
  bundle.count = static_cast<std::uint8_t>(rays.size());
  if (hooks_.transforms == nullptr) tests_.transforms += rays.size();
}

/// The records of a bundle's rays are read, and the rays brought to where the node is.
void Resource::charge_reads(std::span<const std::uint32_t> rays, accel::NodeKey key) {
  reads_ += static_cast<std::uint32_t>(rays.size());
  bundles_.touched += rays.size();
  if (hooks_.transforms == nullptr || !hooks_.transforms->moves(key.instance)) return;
  for (const std::uint32_t slot : rays)
    if ((store_.record(slot).tag.flags & kRayDone) == 0)
      bundle_transforms_ += hooks_.transforms->needs(slot, key.instance);
}

/// Puts the rays of the packet's bundles in the place of these, each with a count for the test to come.
void Resource::expand_bundles(Packet& packet) {
  const bool goes_on = packet.key.ref.is_inner() && !is_treelet(packet.key);
  for (const LocalBundle& local : local_bundles_) {
    packet.members[local.member].mask = 0;
    for (const std::uint32_t slot : store_.rays_of(local.slot)) {
      ++store_.record(slot).pending;
      local_slots_.push_back(slot);
      local_members_.push_back(static_cast<std::uint32_t>(packet.members.size()));
      if (goes_on) packet.members.push_back({store_.id(slot), 0});
    }
    reads_ += store_.bundle(local.slot).count;
    ++bundles_.taken_apart;
  }
}

/// After their rays' tests: the bundles' own ranges, which cost nothing now that the rays are at hand, and counts.
void Resource::add_pending_expanded() {
  for (const LocalBundle& local : local_bundles_) {
    accel::BundleRecord& bundle = store_.bundle(local.slot);
    bundle.tmax = -kInfinity;
    for (const std::uint32_t slot : store_.rays_of(local.slot)) {
      const RayRecord& ray = store_.record(slot);
      if (ray.hit.valid()) bundle.nearest = std::min(bundle.nearest, ray.hit.t);
      if ((ray.tag.flags & kRayDone) == 0) bundle.tmax = std::max(bundle.tmax, ray.hit.t);
    }
    add_pending_bundle(local.slot, -1);
  }
}

void Resource::add_pending_bundle(std::uint32_t slot, std::int32_t pending_change) {
  accel::BundleRecord& bundle = store_.bundle(slot);
  bundle.pending = static_cast<std::int16_t>(bundle.pending + pending_change);
  if constexpr (kChecked) {
    if (bundle.pending < 0)
      throw SimulationError("resource " + std::to_string(id().value) + " bundle " +
                            std::to_string(slot - store_.slots()) + ": more answers than pending tests");
  }
  if (bundle.pending > 0) return;
  ++bundles_.formed;
  bundles_.formed_rays += bundle.count;
  reads_ += bundle.count;
  bundles_.touched += bundle.count;
  for (const std::uint32_t ray : store_.rays_of(slot)) add_pending(ray, -1);
  store_.retire(slot);
  const bool own = slot >= store_.slots() + store_.room().loaded;
  bundles_.loaded += !own;
  bundles_.loaded_rays += own ? 0u : bundle.count;
  (own ? free_bundles_ : freed_slots_).push_back(slot);
}

void Resource::test_whole(Packet& packet) {
  const accel::Node& node = accel_.nodes[packet.key.ref.node()];
  const bool edge_by_edge = settings_.bundles.edges == BundlesConfig::Edges::kSerial;
  const std::uint32_t direct = node.direct & packet.lanes,
                      boxes = packet.lanes & ~std::uint32_t{node.direct} & ((1u << node.count) - 1);
  leaving_.clear();
  bundle_transforms_ = 0;
  for (const LocalBundle& local : local_bundles_) {
    const std::span<const std::uint32_t> rays = store_.rays_of(local.slot);
    // A bundle of the world, at the border of an instance, becomes one of the instance: if there is room for it.
    const bool enters =
        moved(packet.key) && (store_.bundle(local.slot).flags & accel::BundleRecord::kInModelSpace) == 0;
    const bool stays_out = enters && free_bundles_.empty();
    accel::BundleRecord inside;
    if (enters && !stays_out) compute_bounds(rays, packet.key.instance, inside);
    const accel::BundleRecord& bundle = enters ? inside : store_.bundle(local.slot);
    accel::BundleAnswer answer;
    if (stays_out || too_wide(bundle, node)) {
      answer.undecided = static_cast<std::uint8_t>(boxes);
    } else {
      const std::uint64_t tests_before = tests_.bundle;
      answer = accel::test_bundle(accel_, node, boxes, bundle, settings_.bundles, tests_);
      bundle_passes_ +=
          edge_by_edge && answer.edges > 0 ? answer.edges : static_cast<std::uint32_t>(tests_.bundle - tests_before);
    }
    answer.undecided |= static_cast<std::uint8_t>(direct);
    for (std::uint32_t lanes = answer.all; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      packet.nearest[lane] = std::min(packet.nearest[lane], answer.entry[lane]);
    }
    masks_.assign(rays.size(), 0);
    if (answer.undecided != 0 || reformed_ || enters) charge_reads(rays, packet.key);
    if (answer.undecided != 0) {
      if (hooks_.hold_any_hit_rays) any_hit_calls_.assign(rays.size(), 0);
      accel::test_strip(accel_, packet.key, answer.undecided,
                        {store_.records(), rays.data(), rays.size(), nullptr,
                         hooks_.hold_any_hit_rays ? any_hit_calls_.data() : nullptr},
                        {masks_.data(), packet.nearest, nullptr}, tests_);
      hold_back(rays);
    }
    const std::uint8_t together = reformed_ ? 0 : answer.all;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool done = (store_.record(rays[i]).tag.flags & kRayDone) != 0;
      const std::uint32_t apart = masks_[i] | (reformed_ && !done ? answer.all : 0u);
      if (apart != 0) leaving_.push_back({rays[i], static_cast<std::uint8_t>(apart)});
    }
    packet.members[local.member].mask = enters ? std::uint8_t{0} : together;
    bundle_changes_.push_back((enters ? 0 : static_cast<std::int32_t>(bits(together))) - 1);
    if (enters && together != 0) descend_into_instance(packet, rays, inside, together);
    const std::uint64_t lanes = node.count;
    bundles_.all += bits(answer.all);
    bundles_.split += bits(answer.undecided);
    bundles_.none += lanes - bits(answer.all) - bits(answer.undecided);
    bundles_.lane_rays += lanes * rays.size();
    bundles_.split_rays += bits(answer.undecided) * rays.size();
    bundles_.visits += 1;
    bundles_.visit_rays += rays.size();
  }
  if (!local_slots_.empty()) {
    if (reformed_) {
      masks_.resize(local_slots_.size());
      const accel::RayMembers members{store_.records(), local_slots_.data(), local_slots_.size(), nullptr,
                                      any_hit_counters()};
      accel::test_strip(accel_, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, nullptr}, tests_);
      hold_back(local_slots_);
      for (std::size_t i = 0; i < local_slots_.size(); ++i) {
        packet.members[local_members_[i]].mask = 0;
        if (masks_[i] != 0) leaving_.push_back({local_slots_[i], masks_[i]});
      }
    } else {
      test_spread(packet);
    }
  }
  regroup(packet);
  // Only now may counts fall to nothing: whoever goes on has been counted.
  if (reformed_)
    for (const std::uint32_t slot : local_slots_) add_pending(slot, -1);
  for (std::size_t i = 0; i < local_bundles_.size(); ++i)
    add_pending_bundle(local_bundles_[i].slot, bundle_changes_[i]);
}

/// Sends a bundle on as one of the instance that it has come to.
void Resource::descend_into_instance(Packet& packet, std::span<const std::uint32_t> rays,
                                     const accel::BundleRecord& inside, std::uint8_t mask) {
  const std::uint32_t slot = free_bundles_.back();
  free_bundles_.pop_back();
  for (const std::uint32_t ray : rays) ++store_.record(ray).pending;
  packet.members.push_back({store_.make_bundle(slot, rays, static_cast<std::int16_t>(bits(mask))), mask});
  store_.rebound(slot, inside);
}

void Resource::send_alone(Packet& packet, std::uint32_t slot, std::uint8_t mask) {
  store_.record(slot).pending += static_cast<std::int32_t>(bits(mask));
  packet.members.push_back({store_.id(slot), mask});
}

/// Sends on the rays that have left their bundles: those that go the same ways as bundles of their own, if they are
/// to go back to the builder.
void Resource::regroup(Packet& packet) {
  if (!rebuilds_) {
    for (const EjectedRay& ray : leaving_) send_alone(packet, ray.slot, ray.mask);
    return;
  }
  std::stable_sort(leaving_.begin(), leaving_.end(),
                   [](const EjectedRay& a, const EjectedRay& b) { return a.mask < b.mask; });
  for (std::size_t first = 0, end; first < leaving_.size(); first = end) {
    const std::uint8_t mask = leaving_[first].mask;
    regrouped_.clear();
    for (end = first; end < leaving_.size() && leaving_[end].mask == mask; ++end) {
      const RayRecord& record = store_.record(leaving_[end].slot);
      regrouped_.push_back({record.ray, record.tag});
    }
    order_.clear();
    sizes_.clear();
    builder_->group(regrouped_, order_, sizes_);
    std::size_t at = 0;
    for (const std::uint8_t size : sizes_) {
      bundle_slots_.clear();
      for (std::size_t i = at; i < at + size; ++i) bundle_slots_.push_back(leaving_[first + order_[i]].slot);
      at += size;
      if (size == 1 || free_bundles_.empty()) {
        for (const std::uint32_t slot : bundle_slots_) send_alone(packet, slot, mask);
        continue;
      }
      for (const std::uint32_t slot : bundle_slots_) ++store_.record(slot).pending;
      packet.members.push_back(
          {store_.make_bundle(free_bundles_.back(), bundle_slots_, static_cast<std::int16_t>(bits(mask))), mask});
      free_bundles_.pop_back();
    }
  }
}

}  // namespace carousel::ringbus
