#include "ringbus/resource/traversal/bundled.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "ringbus/resource/traversal/bundle_tally.h"
#include "ringbus/resource/visit/count_children.h"

namespace carousel::ringbus {

BundledTraversal::BundledTraversal(const BundlesConfig& config, float scene_size, const VisitContext& context,
                                   std::unique_ptr<TraversalMethod> rays)
    : config_(config),
      reformed_(config.lifetime == BundlesConfig::Lifetime::kReformed),
      returns_(config.split == BundlesConfig::Split::kUntested),
      context_(context),
      rays_(std::move(rays)),
      split_(config, context.accel, scene_size),
      ejected_(config, scene_size, context.store) {
  free_own_bundles();
}

void BundledTraversal::free_own_bundles() {
  const BundleRoom& room = context_.store.room();
  free_bundles_.clear();
  for (std::uint32_t i = room.own; i-- > 0;) free_bundles_.push_back(context_.store.slots() + room.loaded + i);
}

void BundledTraversal::discard() {
  rays_->discard();
  free_own_bundles();
}

void BundledTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  counts_ = BundleCounts{};
  find_bundles(local);
  if (stay_bundled(packet)) {
    test_bundles(packet, local, outcome);
  } else if (tests_leaf(packet)) {
    test_leaf(packet, local, outcome);
  } else {
    take_apart(packet, local, outcome);
    rays_->test(packet, local, outcome);
    end_taken_apart(outcome);
  }
  outcome.bundles = &counts_;
}

/// Moves the bundles among the local members to a list of their own.
void BundledTraversal::find_bundles(LocalRays& local) {
  bundles_.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < local.size(); ++i) {
    if (context_.store.is_bundle(local.slots[i])) {
      bundles_.push_back({local.slots[i], local.members[i]});
      continue;
    }
    local.slots[kept] = local.slots[i];
    local.members[kept++] = local.members[i];
  }
  local.slots.resize(kept);
  local.members.resize(kept);
}

/// True if bundles are tested as such at the packet's node.
bool BundledTraversal::stay_bundled(const Packet& packet) const {
  const accel::NodeKey key = packet.key;
  if (!key.ref.is_inner() || is_treelet(key) || split_.at_node(key, packet.depth)) return false;
  // A bundle that waits for more tests than its record can count goes on as rays.
  return std::none_of(bundles_.begin(), bundles_.end(), [&](const LocalBundle& b) {
    return context_.store.bundle(b.slot).pending > std::numeric_limits<std::int16_t>::max() - accel::kMaxWidth;
  });
}

// ---- where bundles are taken apart

/// Puts the rays of the packet's bundles among the local rays, each with a count for the test to come.
void BundledTraversal::take_apart(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  const bool has_children = packet.key.ref.is_inner() && !is_treelet(packet.key);
  for (const LocalBundle& bundle : bundles_) {
    packet.members[bundle.member].mask = 0;
    for (const std::uint32_t slot : context_.store.rays_of(bundle.slot)) {
      ++context_.store.record(slot).pending;
      local.slots.push_back(slot);
      local.members.push_back(static_cast<std::uint32_t>(packet.members.size()));
      if (has_children) packet.members.push_back({context_.store.id(slot), 0});
    }
    outcome.reads += context_.store.bundle(bundle.slot).count;
    ++counts_.taken_apart;
  }
}

/// After the tests of their rays: updates the ranges of the bundles, which costs nothing as the rays are at hand, and
/// their counts.
void BundledTraversal::end_taken_apart(TestOutcome& outcome) {
  for (const LocalBundle& local : bundles_) {
    update_range(local.slot);
    add_pending(local.slot, -1, outcome);
  }
}

void BundledTraversal::update_range(std::uint32_t slot) {
  accel::BundleRecord& bundle = context_.store.bundle(slot);
  bundle.tmax = -kInfinity;
  for (const std::uint32_t each : context_.store.rays_of(slot)) {
    const RayRecord& ray = context_.store.record(each);
    if (ray.hit.valid()) bundle.nearest = std::min(bundle.nearest, ray.hit.t);
    if ((ray.tag.flags & kRayDone) == 0) bundle.tmax = std::max(bundle.tmax, ray.hit.t);
  }
}

// ---- where bundles go on

void BundledTraversal::test_bundles(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  IntersectionCounts counts;
  transforms_ = 0;
  ejected_.begin();
  for (LocalBundle& bundle : bundles_) test_bundle(packet, bundle, counts, outcome);
  if (!local.empty()) {
    if (reformed_)
      eject_singles(packet, local, outcome);
    else
      rays_->test(packet, local, outcome);
  }
  outcome.bundle_passes.regrouped = ejected_.regrouped();
  counts_.regrouped += ejected_.regrouped();
  ejected_.send(packet, free_bundles_);
  // Only now may counts fall to nothing: every ray that goes on has been counted.
  if (reformed_)
    for (const std::uint32_t slot : local.slots) context_.completion.add_pending(slot, -1);
  for (const LocalBundle& bundle : bundles_) add_pending(bundle.slot, bundle.change, outcome);
  write_transforms(packet.key, counts, outcome);
}

void BundledTraversal::test_bundle(Packet& packet, LocalBundle& local, IntersectionCounts& counts,
                                   TestOutcome& outcome) {
  RayStore& store = context_.store;
  const accel::Node& node = context_.accel.nodes[packet.key.ref.node()];
  const std::uint32_t direct = node.direct & packet.lanes,
                      boxes = packet.lanes & ~std::uint32_t{node.direct} & ((1u << node.count) - 1);
  const std::span<const std::uint32_t> rays = store.rays_of(local.slot);
  // A bundle of the world, at the border of an instance, becomes one of the instance, if there is a slot for it and its
  // rays have bounds there.
  const bool enters =
      split_.in_model_space(packet.key) && (store.bundle(local.slot).flags & accel::BundleRecord::kInModelSpace) == 0;
  std::optional<accel::BundleRecord> inside;
  if (enters && !free_bundles_.empty()) inside = bounds_in(packet.key.instance, rays, counts);
  const bool stays_out = enters && !inside;
  const accel::BundleRecord& bundle = inside ? *inside : store.bundle(local.slot);
  accel::BundleAnswer answer;
  // Without a box of its own a node asks for no bounds, and so for no division.
  const bool untested = boxes == 0 || stays_out || split_.too_wide(bundle, node);
  if (untested) {
    answer.undecided = static_cast<std::uint8_t>(boxes);
  } else {
    answer = accel::test_bundle(context_.accel, node, boxes, bundle, config_, counts);
    add_passes(answer, outcome.bundle_passes);
    if (answer.silhouettes)
      outcome.bundle_passes.divided_after += static_cast<std::uint32_t>(std::popcount(answer.all));
    else
      outcome.bundle_passes.divided_before += accel::kDirectionDivisions;
  }
  if (returns_ && !packet.takes_reserve && answer.undecided != 0 && !stays_out)
    return give_back(packet, local, enters, outcome);
  const std::uint64_t leaf_tests = counts_.leaf_tests;
  answer.undecided |= static_cast<std::uint8_t>(held_in_reach(direct, local, packet.key, counts, outcome));
  if (counts_.leaf_tests > leaf_tests && (answer.silhouettes || untested)) divide_for_directions(counts, outcome);
  for (std::uint32_t lanes = answer.all; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    packet.nearest[lane] = std::min(packet.nearest[lane], answer.entry[lane]);
  }
  masks_.assign(rays.size(), 0);
  if (answer.undecided != 0 || reformed_ || enters) charge_reads(rays, packet.key, outcome);
  if (answer.undecided != 0) {
    accel::RayMembers members = context_.members(rays);
    members.culls = nullptr;
    accel::test_strip(context_.accel, packet.key, answer.undecided, members, {masks_.data(), packet.nearest, nullptr},
                      counts);
    context_.any_hit.hold_back();
  }
  const std::uint8_t together = reformed_ ? 0 : answer.all;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool done = (store.record(rays[i]).tag.flags & kRayDone) != 0;
    const std::uint32_t apart = masks_[i] | (reformed_ && !done ? answer.all : 0u);
    if (apart != 0) ejected_.add(rays[i], static_cast<std::uint8_t>(apart));
    masks_[i] = static_cast<std::uint8_t>(apart | together);
  }
  count_children(masks_, outcome);
  packet.members[local.member].mask = enters ? std::uint8_t{0} : together;
  local.change = (enters ? 0 : std::popcount(together)) - 1;
  if (enters && together != 0) descend_into_instance(packet, rays, *inside, together);
  add_visit(counts_, rays.size(), node.count, std::popcount(answer.all), std::popcount(answer.undecided));
}

/// Primitives are tested by intervals.
void BundledTraversal::divide_for_directions(IntersectionCounts& counts, TestOutcome& outcome) {
  counts.reciprocals += accel::kDirectionDivisions;
  outcome.bundle_passes.divided_before += accel::kDirectionDivisions;
}

void BundledTraversal::add_passes(const accel::BundleAnswer& answer, BundlePasses& passes) const {
  const std::uint32_t first = answer.first_passes, second = answer.second_passes;
  const bool parallel = config_.order == BundlesConfig::Order::kParallel;
  passes.first += parallel ? first + second : first;
  passes.second += parallel ? 0 : second;
  passes.at_once += parallel ? std::max(first, second) : first;
}

/// Tests single rays that are to go on in bundles.
void BundledTraversal::eject_singles(Packet& packet, const LocalRays& local, TestOutcome& outcome) {
  const TransformCharge charge(context_, local.slots, packet.key.instance);
  accel::RayMembers members = context_.members(local.slots);
  members.culls = nullptr;
  masks_.resize(local.size());
  accel::test_strip(context_.accel, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, nullptr},
                    outcome.counts);
  count_children(masks_, outcome);
  context_.any_hit.hold_back();
  for (std::size_t i = 0; i < local.size(); ++i) {
    packet.members[local.members[i]].mask = 0;
    if (masks_[i] != 0) ejected_.add(local.slots[i], masks_[i]);
  }
  charge.write(outcome.counts);
}

/// The bounds of rays in the space of an instance, as the box tests there will see them. None if one of the rays
/// overflows there or has no direction.
std::optional<accel::BundleRecord> BundledTraversal::bounds_in(std::uint32_t instance,
                                                               std::span<const std::uint32_t> rays,
                                                               IntersectionCounts& counts) const {
  accel::BundleRecord bundle;
  for (const std::uint32_t slot : rays) {
    const RayRecord& record = context_.store.record(slot);
    const Ray model = context_.accel.instances[instance].transform.to_model(record.ray);
    if (!accel::valid(model)) return std::nullopt;
    bundle.widen(model, record.hit.t);
  }
  bundle.count = static_cast<std::uint8_t>(rays.size());
  if (context_.transforms != nullptr) return bundle;
  counts.transforms += rays.size();
  if (context_.accel.instances[instance].transform.promoted) counts.transforms_in_double += rays.size();
  return bundle;
}

/// Charges for reading the records of a bundle's rays and for bringing the rays to the node's space.
void BundledTraversal::charge_reads(std::span<const std::uint32_t> rays, accel::NodeKey key, TestOutcome& outcome) {
  outcome.reads += static_cast<std::uint32_t>(rays.size());
  counts_.touched += rays.size();
  charge_transforms(rays, key);
}

void BundledTraversal::charge_transforms(std::span<const std::uint32_t> rays, accel::NodeKey key) {
  if (context_.transforms != nullptr)
    transforms_ += context_.transforms->charge(context_.store.records(), rays, key.instance).transforms;
}

/// Adds the tests of a visit's bundles to `outcome`, with the transforms of their rays. One inversion serves all rays.
void BundledTraversal::write_transforms(accel::NodeKey key, IntersectionCounts& counts, TestOutcome& outcome) const {
  if (context_.transforms != nullptr) {
    counts.transforms = transforms_;
    counts.transforms_in_double = transforms_ > 0 && context_.transforms->in_double(key.instance) ? transforms_ : 0;
    if (transforms_ > 0 && outcome.counts.transforms == 0) context_.transforms->invert(key.instance, counts);
  }
  outcome.counts += counts;
}

/// Sends a bundle on as one of the instance that it has come to.
void BundledTraversal::descend_into_instance(Packet& packet, std::span<const std::uint32_t> rays,
                                             const accel::BundleRecord& inside, std::uint8_t mask) {
  const std::uint32_t slot = free_bundles_.back();
  free_bundles_.pop_back();
  for (const std::uint32_t ray : rays) ++context_.store.record(ray).pending;
  packet.members.push_back(
      {context_.store.make_bundle(slot, rays, static_cast<std::int16_t>(std::popcount(mask))), mask});
  context_.store.rebound(slot, inside);
}

/// A bundle that waits for nothing any more dissolves: its rays lose the count that they held for it.
void BundledTraversal::add_pending(std::uint32_t slot, std::int32_t change, TestOutcome& outcome) {
  RayStore& store = context_.store;
  accel::BundleRecord& bundle = store.bundle(slot);
  bundle.pending = static_cast<std::int16_t>(bundle.pending + change);
  if constexpr (kChecked) {
    if (bundle.pending < 0)
      throw SimulationError("resource " + std::to_string(store.owner().value) + " bundle " +
                            std::to_string(slot - store.slots()) + ": more answers than pending tests");
  }
  if (bundle.pending > 0) return;
  const bool loaded = slot < store.slots() + store.room().loaded;
  add_dissolved(counts_, bundle.count, loaded);
  outcome.reads += bundle.count;
  for (const std::uint32_t ray : store.rays_of(slot)) context_.completion.add_pending(ray, -1);
  store.retire(slot);
  loaded ? context_.completion.free_slot(slot) : free_bundles_.push_back(slot);
}

}  // namespace carousel::ringbus
