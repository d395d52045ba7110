#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/workload.h"

namespace carousel::ringbus::cycle {

/// Hands completed rays over when the last visit that tests them has ended. The results of a visit are known when it
/// begins, so a ray may seem complete at the end of a visit while an earlier one, in another context, still tests it.
/// Or an answer to its any-hit calls comes while its last visit has not ended.
///
/// Does nothing unless it is on: with one context no ray is in two visits, and without calls none is completed in one.
/// Rays of bundles are not followed.
class RaysInTest {
 public:
  RaysInTest(std::size_t slots, bool on) : visits_(on ? slots : 0) {}

  /// A visit begins to test the rays in `slots`; it keeps them in `tested` until end().
  void begin(std::span<const std::uint32_t> slots, std::vector<std::uint32_t>& tested) {
    if (visits_.empty()) return;
    tested.assign(slots.begin(), slots.end());
    for (const std::uint32_t slot : slots) ++visits_[slot];
  }
  void end(std::vector<std::uint32_t>& tested) {
    for (const std::uint32_t slot : tested) --visits_[slot];
    tested.clear();
  }
  /// Moves rays and the slots that they leave to `done` and `freed`: first those that were kept back and are in no test
  /// any more, then the completed ones. Rays that are still in test are kept back. Both are empty afterwards.
  void hand_over(HitBatch& rays, std::vector<std::uint32_t>& slots, HitBatch& done, std::vector<std::uint32_t>& freed) {
    if (done.empty()) done.reserve(rays.size());
    if (freed.empty()) freed.reserve(slots.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < late_.size(); ++i) {
      if (visits_[late_slots_[i]] == 0) {
        done.push_back(late_[i]);
        freed.push_back(late_slots_[i]);
      } else {
        late_[kept] = late_[i];
        late_slots_[kept++] = late_slots_[i];
      }
    }
    late_.resize(kept);
    late_slots_.resize(kept);
    // With bundles there are slots of bundles besides, and it is off.
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool in_test = !visits_.empty() && visits_[slots[i]] > 0;
      (in_test ? late_ : done).push_back(rays[i]);
      if (in_test) late_slots_.push_back(slots[i]);
    }
    if (visits_.empty())
      freed.insert(freed.end(), slots.begin(), slots.end());
    else
      for (const std::uint32_t slot : slots)
        if (visits_[slot] == 0) freed.push_back(slot);
    rays.clear();
    slots.clear();
  }
  /// Forgets all visits and rays.
  void clear() {
    visits_.assign(visits_.size(), 0);
    late_.clear();
    late_slots_.clear();
  }

 private:
  std::vector<std::uint16_t> visits_;  // by slot: how many test the ray in it
  HitBatch late_;                      // complete, and still in test
  std::vector<std::uint32_t> late_slots_;
};

}  // namespace carousel::ringbus::cycle
