#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/config/config.h"
#include "core/types/workload.h"

namespace carousel::ringbus::cycle {

/// Completed rays that wait for shader workers. With `distribute: fifo_fill` there is one queue, and any idle worker
/// takes its first ray. Otherwise each worker has a queue, which is chosen when a ray comes: the worker with the fewest
/// rays waiting and in work, each in turn, or at random, which depends on the ray and not on when it comes.
class ShadeQueues {
 public:
  ShadeQueues(ShadingConfig::Distribute distribute, std::size_t workers, std::uint64_t seed);

  void push(const RayResult& ray);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// The ray that has waited longest for `worker`.
  std::optional<RayResult> take(std::uint32_t worker);
  /// The first ray of the longest queue, for a resource that helps.
  std::optional<RayResult> take_any();
  /// Sets how many rays `worker` has in work.
  void set_in_work(std::uint32_t worker, std::size_t rays) { in_work_[worker] = rays; }

 private:
  std::size_t queue_for(const RayResult& ray);
  std::optional<RayResult> take_from(std::deque<RayResult>& queue);

  ShadingConfig::Distribute distribute_;
  std::uint64_t seed_;
  std::vector<std::deque<RayResult>> queues_;
  std::vector<std::size_t> in_work_;  // by worker
  std::size_t turn_ = 0, size_ = 0;
};

}  // namespace carousel::ringbus::cycle
