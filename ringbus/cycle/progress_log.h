#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/results/class_use.h"

namespace carousel::ringbus::cycle {

/// Samples of a run's progress at about equal numbers of rays: some hundreds, however long the run is. When there are
/// too many, every second one is dropped and the distance between them doubled.
class ProgressLog {
 public:
  /// True if a sample at so many completed rays would be kept.
  bool wants(std::uint64_t completed) const { return completed >= next_; }
  void add(ProgressSample sample) {
    next_ = sample.completed + step_;
    samples_.push_back(std::move(sample));
    if (samples_.size() < kMost) return;
    for (std::size_t i = 1; 2 * i < kMost; ++i) samples_[i] = std::move(samples_[2 * i]);
    samples_.resize(kMost / 2);
    step_ *= 2;
    next_ = samples_.back().completed + step_;
  }
  const std::vector<ProgressSample>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kMost = 512;
  std::vector<ProgressSample> samples_;
  std::uint64_t step_ = 16, next_ = 1;
};

}  // namespace carousel::ringbus::cycle
