// What a packet's visit does: the rays that live here are tested, everything else passes through untouched.
#include <array>
#include <bit>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "ringbus/resource/farthest_first.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

namespace {

// The baseline instruction set has no population count, and a call for eight bits is dear.
constexpr std::array<std::int8_t, 256> kBitCount = [] {
  std::array<std::int8_t, 256> counts{};
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] = static_cast<std::int8_t>(counts[i / 2] + (i & 1));
  return counts;
}();

}  // namespace

void Resource::gather_local(const Packet& packet) {
  local_slots_.resize(packet.members.size());
  local_members_.resize(packet.members.size());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < packet.members.size(); ++i) {
    const RayId ray = packet.members[i].ray;
    const bool local = store_.owns(ray);
    // Written either way and counted if it is one of ours: with two owners no predictor guesses which.
    local_slots_[count] = local ? store_.slot(ray) : 0;
    local_members_[count] = i;
    count += local;
  }
  local_slots_.resize(count);
  local_members_.resize(count);
}

void Resource::add_pending(std::uint32_t slot, std::int32_t pending_change) {
  RayRecord& record = store_.record(slot);
  record.pending += pending_change;
  if constexpr (kChecked) {
    if (record.pending < 0)
      throw SimulationError("resource " + std::to_string(id().value) + " slot " + std::to_string(slot) +
                            ": more answers than pending tests");
  }
  if (record.pending == 0) complete(slot);
}

void Resource::complete(std::uint32_t slot) {
  accel::finish_record(store_.record(slot), completed_);
  if (ordered_) stacks_->clear(slot);
  if (hooks_.transforms != nullptr) hooks_.transforms->forget(slot);
  store_.retire(slot);
  freed_slots_.push_back(slot);
}

// Before the tests, which may complete rays.
IntersectionCounts Resource::transforms_of(accel::NodeKey key) {
  IntersectionCounts counts;
  if (!hooks_.transforms->moves(key.instance)) return counts;
  for (const std::uint32_t slot : local_slots_)
    if ((store_.record(slot).tag.flags & kRayDone) == 0)
      counts.transforms += hooks_.transforms->needs(slot, key.instance);
  counts.inversions =
      counts.transforms > 0 && hooks_.transforms->inverts(key.instance);  // one for all rays of the visit
  return counts;
}

/// Where the kernels are to note how often they asked, a member each; null when nobody wants to know.
std::uint8_t* Resource::any_hit_counters() {
  if (!hooks_.hold_any_hit_rays) return nullptr;
  any_hit_calls_.assign(local_slots_.size(), 0);
  return any_hit_calls_.data();
}

/// Gives the rays that asked a count to wait for, before those of the test are taken from them.
void Resource::hold_back(std::span<const std::uint32_t> slots) {
  if (!hooks_.hold_any_hit_rays) return;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (any_hit_calls_[i] == 0) continue;
    ++store_.record(slots[i]).pending;
    any_hit_rays_.push_back({slots[i], any_hit_calls_[i]});
  }
}

TestOutcome Resource::test(Packet& packet) {
  any_hit_rays_.clear();
  gather_local(packet);
  tests_ = IntersectionCounts{};
  bundles_ = BundleCounts{};
  bundle_passes_ = 0;
  if (bundled_) find_bundles();
  reads_ = static_cast<std::uint32_t>(local_slots_.size() + local_bundles_.size());
  const std::size_t seen = reads_;
  const bool whole = bundled_ && bundles_go_on(packet);
  if (!local_bundles_.empty() && !whole) expand_bundles(packet);
  if (seen > 0) {
    const bool accounted =
        hooks_.transforms != nullptr && !is_treelet(packet.key);  // a subtree's tracer does it itself
    const IntersectionCounts moved = accounted ? transforms_of(packet.key) : IntersectionCounts{};
    if (ordered_)
      test_ordered(packet);
    else if (whole)
      test_whole(packet);
    else
      test_spread(packet);
    if (!whole) add_pending_expanded();
    if (accounted) {
      const std::uint64_t of_bundles = whole ? bundle_transforms_ : 0;
      tests_.transforms = moved.transforms + of_bundles;
      tests_.inversions = moved.inversions;
      if (moved.transforms == 0 && of_bundles > 0) tests_.inversions = hooks_.transforms->inverts(packet.key.instance);
    }
  }
  record({.kind = EventKind::kTest,
          .resource = id(),
          .key = packet.key,
          .rays = static_cast<std::uint32_t>(seen),
          .reads = reads_,
          .depth = packet.depth,
          .tests = tests_,
          .bundles = bundled_ ? &bundles_ : nullptr,
          .members = packet.members});
  return {tests_, local_slots_.size(), reads_, bundle_passes_, any_hit_rays_};
}

void Resource::test_spread(Packet& packet) {
  const accel::RayMembers members{store_.records(), local_slots_.data(), local_slots_.size(), culls_,
                                  any_hit_counters()};
  if (is_treelet(packet.key) || !packet.key.ref.is_inner()) {
    if (is_treelet(packet.key) && hooks_.subtree_tracer != nullptr)
      hooks_.subtree_tracer->trace(packet.key, members, tests_);
    else if (is_treelet(packet.key))
      accel::trace_interleaved(accel_, packet.key, members, tests_);
    else
      accel::test_strip(accel_, packet.key, packet.lanes, members, {}, tests_);
    hold_back(local_slots_);
    for (const std::uint32_t slot : local_slots_) add_pending(slot, -1);
    return;
  }
  masks_.resize(local_slots_.size());
  accel::test_strip(accel_, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, nullptr}, tests_);
  hold_back(local_slots_);
  if (!single_) {
    for (std::size_t i = 0; i < local_slots_.size(); ++i) {
      packet.members[local_members_[i]].mask = masks_[i];
      add_pending(local_slots_[i], kBitCount[masks_[i]] - 1);
    }
    return;
  }
  // One shape a packet: a hit child brings as many tests as it has shapes (DESIGN.md section 4).
  const int lane = std::countr_zero(packet.lanes);
  const accel::Node& node = accel_.nodes[packet.key.ref.node()];
  const std::int32_t below = tests_of(settings_, accel_, accel_.child_key(packet.key, lane), node.strip_size[lane]);
  for (std::size_t i = 0; i < local_slots_.size(); ++i) {
    packet.members[local_members_[i]].mask = masks_[i];
    add_pending(local_slots_[i], (masks_[i] != 0 ? below : 0) - 1);
  }
}

void Resource::test_ordered(Packet& packet) {
  const accel::RayMembers members{store_.records(), local_slots_.data(), local_slots_.size(), culls_,
                                  any_hit_counters()};
  if (packet.key.ref.is_inner()) {
    masks_.resize(local_slots_.size());
    entries_.resize(accel::kMaxWidth * local_slots_.size());
    accel::test_strip(accel_, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, entries_.data()},
                      tests_);
  } else {
    masks_.assign(local_slots_.size(), 0);
    accel::test_strip(accel_, packet.key, packet.lanes, members, {}, tests_);
  }
  hold_back(local_slots_);
  for (std::size_t i = 0; i < local_slots_.size(); ++i) {
    const std::uint32_t slot = local_slots_[i];
    const float* entry = entries_.data() + accel::kMaxWidth * i;
    farthest_first(masks_[i], entry, [&](int lane) {
      stacks_->push(
          slot, {accel_.child_key(packet.key, lane), entry[lane], static_cast<std::uint16_t>(packet.depth + 1), true});
    });
    const RayRecord& ray = store_.record(slot);
    const bool done = (ray.tag.flags & kRayDone) != 0;
    const NextNode next = done ? NextNode{} : stacks_->pop(slot, ray.hit.t);
    packet.next[local_members_[i]] = next;
    if (!next.any) add_pending(slot, -1);
  }
}

}  // namespace carousel::ringbus
