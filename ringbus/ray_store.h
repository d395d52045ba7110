#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "accel/ray_check.h"
#include "core/config.h"
#include "core/error.h"
#include "core/huge_pages.h"
#include "core/workload.h"
#include "ringbus/ray_id.h"

namespace carousel::ringbus {

/// A resource's ray data: records in slots. Ray control hands out the slots and fills in the records of new
/// rays; from then on until the slot is freed a record is touched by its owner's thread only.
class RayStore {
 public:
  RayStore(ResourceId owner, std::uint32_t slots) : owner_(owner), layout_(slots), records_(slots) {
    if constexpr (kChecked) generations_.resize(slots);
  }

  /// Puts a ray into a free slot, waiting for `tests` tests. The ID is valid until the slot is freed.
  RayId load(std::uint32_t slot, const RayRequest& request, std::int32_t tests) {
    accel::start_record(request, records_[slot]);
    records_[slot].pending = tests;
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(++generations_[slot]);
    return id;
  }
  /// Brings a record near that is about to be written.
  void prefetch(std::uint32_t slot) const { __builtin_prefetch(&records_[slot], 1); }
  /// Marks a slot as free: its IDs are stale from now on. Handing it out again is ray control's affair.
  void retire(std::uint32_t slot) {
    if constexpr (kChecked) ++generations_[slot];
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
  std::uint32_t slots() const { return static_cast<std::uint32_t>(records_.size()); }
  const RayIdLayout& layout() const { return layout_; }

 private:
  ResourceId owner_;
  RayIdLayout layout_;
  std::vector<RayRecord, HugePageAllocator<RayRecord>> records_;
  std::vector<std::uint32_t> generations_;   // odd while in use; checked builds only
};

/// One for each resource.
inline std::vector<std::unique_ptr<RayStore>> make_ray_stores(const Config& config) {
  std::vector<std::unique_ptr<RayStore>> stores;
  for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(config.topology.resources); ++r)
    stores.push_back(std::make_unique<RayStore>(ResourceId(r), static_cast<std::uint32_t>(config.rays.slots_per_resource)));
  return stores;
}

}  // namespace carousel::ringbus
