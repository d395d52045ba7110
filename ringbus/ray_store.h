#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/ray.h"
#include "ringbus/ray_id.h"

namespace carousel::ringbus {

/// A resource's ray data: records in slots that are handed out and freed. Owner's thread only.
class RayStore {
 public:
  RayStore(ResourceId owner, std::uint32_t slots) : owner_(owner), layout_(slots), records_(slots) {
    free_.reserve(slots);
    for (std::uint32_t slot = slots; slot-- > 0;) free_.push_back(slot);
    if constexpr (kChecked) generations_.resize(slots);
  }

  /// Needs a free slot; its record is the caller's to fill. The ID is valid until the slot is freed.
  RayId allocate() {
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    RayId id = layout_.make(owner_, slot);
    if constexpr (kChecked) id.generation.set(++generations_[slot]);
    ++allocated_;
    return id;
  }
  void free(std::uint32_t slot) {
    if constexpr (kChecked) ++generations_[slot];
    free_.push_back(slot);
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

  RayRecord* records() { return records_.data(); }
  RayRecord& record(std::uint32_t slot) { return records_[slot]; }
  std::size_t slots() const { return records_.size(); }
  std::size_t free_slots() const { return free_.size(); }
  std::uint64_t allocated() const { return allocated_; }
  const RayIdLayout& layout() const { return layout_; }

 private:
  ResourceId owner_;
  RayIdLayout layout_;
  std::vector<RayRecord> records_;
  std::vector<std::uint32_t> free_;   // last freed, first used: its record is still in cache
  std::vector<std::uint32_t> generations_;   // odd while in use; checked builds only
  std::uint64_t allocated_ = 0;
};

}  // namespace carousel::ringbus
