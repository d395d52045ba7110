#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/visit/test_outcome.h"

namespace carousel::ringbus {

/// Holds back rays whose any-hit calls a shader worker answers: each waits for one answer more. Does nothing unless it
/// is on.
class AnyHitHold {
 public:
  /// Keeps a reference.
  AnyHitHold(RayStore& store, bool on) : store_(store), on_(on) {}

  /// A new visit.
  void begin() { calls_.clear(); }
  /// Counters of any-hit calls for the next test of `rays` rays, one a ray; null when it is off.
  std::uint8_t* counters(std::size_t rays) {
    if (!on_) return nullptr;
    counters_.assign(rays, 0);
    return counters_.data();
  }
  /// Adds one to the counts of the tested rays that made calls. To be called before the test is taken from them.
  void hold_back(std::span<const std::uint32_t> slots) {
    if (!on_) return;
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (counters_[i] == 0) continue;
      ++store_.record(slots[i]).pending;
      calls_.push_back({slots[i], counters_[i]});
    }
  }
  /// The rays held back during this visit.
  std::span<const AnyHitCall> calls() const { return calls_; }

 private:
  RayStore& store_;
  bool on_;
  std::vector<std::uint8_t> counters_;
  std::vector<AnyHitCall> calls_;
};

}  // namespace carousel::ringbus
