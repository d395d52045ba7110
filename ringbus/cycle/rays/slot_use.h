#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numeric/log2_histogram.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Notes how many slots of each resource are in use, and how long rays stay in them: from being given one until their
/// hit comes to shading.
class SlotUse {
 public:
  explicit SlotUse(const Machine& machine) : held_(machine.stores.size()) {
    for (const auto& store : machine.stores) placed_at_.emplace_back(store->slots());
  }

  /// A ray has got this slot.
  void placed(ResourceId owner, std::uint32_t slot, Cycle now) { placed_at_[owner.value][slot] = now; }
  /// Rays, or a bundle with its rays, have got `records` slots.
  void taken(ResourceId owner, std::uint64_t records, Cycle now) {
    held_[owner.value].change(now, static_cast<std::int64_t>(records));
  }
  /// Slots are free again; those of bundles count as in use, and have no time of their own.
  void freed(ResourceId owner, std::span<const std::uint32_t> slots, Cycle now) {
    const std::vector<Cycle>& placed_at = placed_at_[owner.value];
    for (const std::uint32_t slot : slots)
      if (slot < placed_at.size()) residence_.add(now - placed_at[slot]);
    held_[owner.value].change(now, -static_cast<std::int64_t>(slots.size()));
  }
  /// A ray that found its slot by itself in cycle `placed` has given it back.
  void came_back(Cycle placed, Cycle now) { residence_.add(now - placed); }
  /// All slots are empty.
  void clear(Cycle now) {
    for (Level& held : held_) held.clear(now);
  }

  const Log2Histogram& residence() const { return residence_; }
  const std::vector<Level>& held() const { return held_; }

 private:
  std::vector<Level> held_;                    // by resource: slots in use
  std::vector<std::vector<Cycle>> placed_at_;  // by resource and slot of a ray
  Log2Histogram residence_;
};

}  // namespace carousel::ringbus::cycle
