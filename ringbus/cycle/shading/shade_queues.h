#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/config/config.h"
#include "core/types/workload.h"

namespace carousel::ringbus::cycle {

/// Completed rays that wait for shader workers. `distribute: fifo_fill`: one queue, whoever is idle takes the first.
/// Otherwise a queue a worker, chosen when a ray comes: by load the worker with the fewest rays waiting and in hand,
/// each in turn, or at random, which depends on the ray and not on when it comes.
class ShadeQueues {
 public:
  ShadeQueues(const ShadingConfig& config, std::uint64_t seed);

  void push(const RayResult& ray);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// The ray that has waited longest for `worker`.
  std::optional<RayResult> take(std::uint32_t worker);
  /// The first of the longest queue, for somebody who is no worker.
  std::optional<RayResult> take_any();
  /// How many rays `worker` is at.
  void hold(std::uint32_t worker, std::size_t rays) { egress_[worker] = rays; }

 private:
  std::size_t queue_for(const RayResult& ray);
  std::optional<RayResult> take_from(std::deque<RayResult>& queue);

  ShadingConfig::Distribute distribute_;
  std::uint64_t seed_;
  std::vector<std::deque<RayResult>> queues_;
  std::vector<std::size_t> egress_;  // by worker
  std::size_t turn_ = 0, size_ = 0;
};

}  // namespace carousel::ringbus::cycle
