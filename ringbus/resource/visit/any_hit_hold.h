#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/any_hit.h"
#include "core/types/workload.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus {

/// Holds back rays whose any-hit calls a shader worker answers: each waits for one answer more. Does nothing unless it
/// is on.
class AnyHitHold {
 public:
  /// Keeps a reference.
  AnyHitHold(RayStore& store, bool on) : store_(store), on_(on) {}

  /// A new visit.
  void begin() {
    slots_.clear();
    calls_.clear();
  }
  /// Where the next test notes its any-hit calls; null when it is off.
  std::vector<AnyHitCall>* next_test() {
    noted_.clear();
    return on_ ? &noted_ : nullptr;
  }
  /// Adds one to the counts of the tested rays that made calls. To be called before the test is taken from them.
  void hold_back() {
    const RayRecord* last = nullptr;
    for (const AnyHitCall& call : noted_) {
      if (call.record != last) {
        const auto slot = static_cast<std::uint32_t>(call.record - store_.records());
        ++store_.record(slot).pending;
        slots_.push_back(slot);
      }
      last = call.record;
      calls_.push_back(completed_at(call));
    }
    noted_.clear();
  }
  /// The rays held back during this visit, and their calls.
  std::span<const std::uint32_t> slots() const { return slots_; }
  std::span<const RayResult> calls() const { return calls_; }

  /// A call as a shader worker gets it: the ray with the place of the call for its hit.
  static RayResult completed_at(const AnyHitCall& call) { return {call.record->ray, call.place, call.record->tag}; }

 private:
  RayStore& store_;
  bool on_;
  std::vector<AnyHitCall> noted_;     // of the present test, the calls of a ray together
  std::vector<std::uint32_t> slots_;  // of the visit, as those below
  std::vector<RayResult> calls_;
};

}  // namespace carousel::ringbus
