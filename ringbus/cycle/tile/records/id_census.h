#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The number of ray IDs in a resource's collections at regular times, the same for all resources of a machine, so that
/// their sum is a number of one time. Keeps 2048 to 4095 samples: when there are 4096, every other one is dropped and
/// the interval doubles.
class IdCensus {
 public:
  /// The number has been `ids` since the last call, and may change at `now`.
  void until(Cycle now, std::size_t ids) {
    while (next_ < now) {
      samples_.push_back(static_cast<std::uint32_t>(ids));
      next_ += interval_;
      if (samples_.size() < kMost) continue;
      for (std::size_t i = 0; i < kMost / 2; ++i) samples_[i] = samples_[2 * i];
      samples_.resize(kMost / 2);
      interval_ *= 2;
    }
  }

  /// By time: the number at the end of cycles 0, interval(), 2 * interval(), ...
  const std::vector<std::uint32_t>& samples() const { return samples_; }
  Cycle interval() const { return interval_; }

 private:
  static constexpr std::size_t kMost = 4096;
  std::vector<std::uint32_t> samples_;
  Cycle interval_ = 1, next_ = 0;
};

}  // namespace carousel::ringbus::cycle
