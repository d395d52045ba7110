#pragma once

#include <algorithm>
#include <deque>
#include <utility>

#include "core/types/workload.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Sorts completed rays by shader on their way to the queues (`shading.sort: shader`; US 9633468: results that need the
/// same next step are made contiguous). It takes `rays_per_cycle` rays a cycle, in the order in which they come, and
/// has each a cycle later at the end of its queue.
class ShadeSorter {
 public:
  explicit ShadeSorter(std::size_t rays_per_cycle) : rate_(rays_per_cycle) {}

  void push(const RayResult& ray, Cycle now) {
    if (now > taking_) taking_ = now, taken_ = 0;
    if (taken_ == rate_) ++taking_, taken_ = 0;
    ++taken_;
    rays_.emplace_back(taking_ + 1, ray);
  }
  std::size_t size() const { return rays_.size(); }
  Cycle next() const { return rays_.empty() ? kNever : rays_.front().first; }
  /// next() is the present cycle, or an earlier one.
  RayResult take() {
    const RayResult ray = rays_.front().second;
    rays_.pop_front();
    return ray;
  }

 private:
  std::size_t rate_, taken_ = 0;  // in cycle taking_
  Cycle taking_ = 0;
  std::deque<std::pair<Cycle, RayResult>> rays_;  // with the cycle in which it is at its place
};

}  // namespace carousel::ringbus::cycle
