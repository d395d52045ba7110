#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accel/box/bundle.h"
#include "accel/structure/accel.h"
#include "accel/traverse/ray_check.h"
#include "core/config/fields/bundles.h"
#include "core/system/error.h"
#include "core/system/huge_pages.h"
#include "core/types/workload.h"
#include "ringbus/rays/nearest_rays.h"
#include "ringbus/rays/rank_share.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus {

/// Room for bundles beside the rays: records that ray control hands out with new rays, and records that the owner keeps
/// for the bundles that it makes of the rays of split ones.
struct BundleRoom {
  std::uint32_t loaded = 0, own = 0;
  std::uint32_t rays = 0;  ///< that a bundle has at most
};

/// A resource's ray data: records in slots. Ray control hands out the slots and fills in the records of new rays. From
/// then on until the slot is freed only the owner's thread touches the record. Records of bundles have the slots behind
/// the rays' slots, and IDs of the same kind.
class RayStore {
 public:
  /// `here`: false where another rank plays the resource, which then keeps the records.
  /// `named`: places that the IDs of a machine tell apart, at least those of this store, as all stores share a layout.
  RayStore(ResourceId owner, std::uint32_t slots, BundleRoom room = {}, bool here = true, std::uint32_t named = 0)
      : owner_(owner),
        slots_(slots),
        layout_(std::max(named, slots + room.loaded + room.own)),
        records_(here ? slots : 0),
        room_(room),
        bundles_(room.loaded + room.own),
        bundle_rays_(bundles_.size() * room.rays) {
    if constexpr (kChecked) generations_.resize(slots + bundles_.size());
  }

  /// Puts a ray into a free slot, waiting for `tests` tests. The ID is valid until the slot is freed.
  RayId load(std::uint32_t slot, const RayRequest& request, std::int32_t tests) {
    start(slot, request, tests);
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(++generations_[slot]);
    return id;
  }
  /// Hands out a free slot of a resource that another rank plays. The ID is valid until retire().
  RayId lease(std::uint32_t slot) {
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(++generations_[slot]);
    return id;
  }
  /// Puts a ray into the slot of an ID that another rank has made by lease(), waiting for `tests` tests.
  void load_leased(RayId id, const RayRequest& request, std::int32_t tests) {
    const std::uint32_t slot = layout_.slot(id);
    start(slot, request, tests);
    if constexpr (kChecked) generations_[slot] = id.generation.get();
  }
  /// Its rays look for several hits from now on (`rays.query.nearest`), as NearestRays says.
  void find_nearest(const QueryConfig& query, const accel::Accel& accel) {
    nearest_ = std::make_unique<NearestRays>(query, accel, static_cast<std::uint32_t>(records_.size()));
  }
  /// Null if rays look for one hit.
  NearestRays* nearest() { return nearest_.get(); }
  const NearestRays* nearest() const { return nearest_.get(); }
  /// Appends the result of the ray in `slot`, which is complete.
  void finish(std::uint32_t slot, HitBatch& out) {
    if (nearest_ == nullptr)
      accel::finish_record(records_[slot], out);
    else
      nearest_->finish(records_[slot], out);
  }
  /// Makes a bundle, waiting for `tests` tests, of the rays in `ray_slots`; `slot` is a free one for bundles. Changes
  /// no ray's count.
  RayId make_bundle(std::uint32_t slot, std::span<const std::uint32_t> ray_slots, std::int16_t tests) {
    accel::BundleRecord& bundle = this->bundle(slot) = accel::BundleRecord();
    bundle.rays = (slot - slots()) * room_.rays;
    bundle.count = static_cast<std::uint8_t>(ray_slots.size());
    bundle.pending = tests;
    std::copy(ray_slots.begin(), ray_slots.end(), bundle_rays_.begin() + bundle.rays);
    for (const std::uint32_t ray : ray_slots) {
      const RayRecord& record = records_[ray];
      bundle.widen(record.ray, record.hit.t);
      if (record.hit.valid()) bundle.nearest = std::min(bundle.nearest, record.hit.t);
    }
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(++generations_[slot]);
    return id;
  }
  /// Gives a bundle the bounds that its rays have in the space of an instance.
  void rebound(std::uint32_t slot, const accel::BundleRecord& bounds) {
    accel::BundleRecord& bundle = this->bundle(slot);
    const accel::BundleRecord before = bundle;
    bundle = bounds;
    bundle.flags = accel::BundleRecord::kInModelSpace;
    bundle.tmax = before.tmax;
    bundle.nearest = before.nearest;
    bundle.pending = before.pending;
    bundle.count = before.count;
    bundle.rays = before.rays;
  }
  /// The ID of a slot in use.
  RayId id(std::uint32_t slot) const {
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(generations_[slot]);
    return id;
  }
  bool is_bundle(std::uint32_t slot) const { return slot >= slots(); }
  accel::BundleRecord& bundle(std::uint32_t slot) { return bundles_[slot - slots()]; }
  /// The slots of a bundle's rays.
  std::span<const std::uint32_t> rays_of(std::uint32_t slot) const {
    const accel::BundleRecord& bundle = bundles_[slot - slots()];
    return std::span(bundle_rays_).subspan(bundle.rays, bundle.count);
  }
  const BundleRoom& room() const { return room_; }
  /// Fetches a record that is about to be written into the cache.
  void prefetch(std::uint32_t slot) const { __builtin_prefetch(&records_[slot], 1); }
  /// Marks a slot as free: its IDs are stale from now on. Ray control hands it out again.
  void retire(std::uint32_t slot) {
    if constexpr (kChecked) ++generations_[slot];
  }
  /// Marks every slot as free.
  void discard() {
    // IDs of slots in use become stale, and all counts even, as they are for free slots.
    if constexpr (kChecked)
      for (std::uint32_t& generation : generations_) generation = (generation + 3) & ~1u;
  }
  bool owns(RayId id) const { return layout_.owner(id) == owner_; }
  /// The slot of an ID this resource owns; in checked builds a stale ID is a SimulationError.
  std::uint32_t slot(RayId id) const {
    const std::uint32_t slot = layout_.slot(id);
    if constexpr (kChecked) {
      if (id.generation.get() != generations_[slot])
        throw SimulationError("stale ray ID: resource " + std::to_string(owner_.value) + " slot " +
                              std::to_string(slot) + " is at generation " + std::to_string(generations_[slot]) +
                              ", the ID at " + std::to_string(id.generation.get()));
    }
    return slot;
  }

  ResourceId owner() const { return owner_; }
  RayRecord* records() { return records_.data(); }
  RayRecord& record(std::uint32_t slot) { return records_[slot]; }
  std::uint32_t slots() const { return slots_; }
  const RayIdLayout& layout() const { return layout_; }

 private:
  void start(std::uint32_t slot, const RayRequest& request, std::int32_t tests) {
    accel::start_record(request, records_[slot]);
    records_[slot].pending = tests;
    if (nearest_ != nullptr) nearest_->start(slot, records_[slot]);
  }

  ResourceId owner_;
  std::uint32_t slots_;
  RayIdLayout layout_;
  std::vector<RayRecord, HugePageAllocator<RayRecord>> records_;
  std::unique_ptr<NearestRays> nearest_;
  BundleRoom room_;
  std::vector<accel::BundleRecord> bundles_;
  std::vector<std::uint32_t> bundle_rays_;  // slots, `room_.rays` a bundle
  std::vector<std::uint32_t> generations_;  // odd while in use; checked builds only
};

/// Room for a quarter as many bundles as slots, as a bundle has at least two rays and rarely so few. Where it is not
/// enough, rays stay single.
inline BundleRoom bundle_room(const BundlesConfig& bundles, std::int64_t slots) {
  if (bundles.size == 0) return {};
  const std::uint32_t quarter = static_cast<std::uint32_t>(slots / 4 + 1);
  const bool rebuilds = bundles.split != BundlesConfig::Split::kTester ||
                        bundles.lifetime == BundlesConfig::Lifetime::kReformed ||
                        bundles.at_instances == BundlesConfig::AtInstances::kRebound;
  return {quarter, rebuilds ? 2 * quarter : 0, static_cast<std::uint32_t>(bundles.size)};
}

/// One for each resource, with its slots and room for bundles. `slots` by resource.
inline std::vector<std::unique_ptr<RayStore>> make_ray_stores(const std::vector<std::int64_t>& slots,
                                                              const BundlesConfig& bundles,
                                                              const RankShare& share = {}) {
  const std::int64_t most = *std::max_element(slots.begin(), slots.end());
  const BundleRoom largest = bundle_room(bundles, most);
  const std::uint32_t named = static_cast<std::uint32_t>(most) + largest.loaded + largest.own;
  std::vector<std::unique_ptr<RayStore>> stores;
  for (std::uint32_t r = 0; r < slots.size(); ++r)
    stores.push_back(std::make_unique<RayStore>(ResourceId(r), static_cast<std::uint32_t>(slots[r]),
                                                bundle_room(bundles, slots[r]), share.here(ResourceId(r)), named));
  return stores;
}

}  // namespace carousel::ringbus
