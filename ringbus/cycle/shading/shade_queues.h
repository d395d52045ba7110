#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/fields/shading.h"
#include "core/types/workload.h"
#include "ringbus/time/fifo.h"

namespace carousel::ringbus::cycle {

/// Completed rays that a worker shades side by side, each with its shader. A vector takes its shaders one after
/// another.
struct ShadeVector {
  HitBatch rays;
  std::vector<std::uint32_t> shaders;
};

/// Completed rays that wait for shader workers. With `distribute: fifo_fill` there is one queue, and any idle worker
/// takes from it. Otherwise each worker has a queue, which is chosen when a ray comes: the worker with the fewest
/// rays waiting and in work, each in turn, or at random, which depends on the ray and not on when it comes.
///
/// A worker takes the rays that have waited longest. With `sort: shader` a queue has a list for each shader, and a
/// worker takes rays of one list: of those lists that fill a vector, or if none does of all, the one whose first ray
/// has waited longest. So the empty places of a vector are filled with rays that need the same next step.
class ShadeQueues {
 public:
  ShadeQueues(const ShadingConfig& shading, std::size_t workers, std::uint64_t seed);

  void push(const RayResult& ray, std::uint32_t shader);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Puts up to `shading.lanes` rays for `worker` into `vector`, in place of what it had; returns whether there are
  /// any.
  bool take(std::uint32_t worker, ShadeVector& vector);
  /// The first ray of the longest queue, for a resource that helps.
  std::optional<RayResult> take_any();
  /// Sets how many rays `worker` has in work.
  void set_in_work(std::uint32_t worker, std::size_t rays) { in_work_[worker] = rays; }

 private:
  struct Waiting {
    std::uint64_t order;  // in which they came
    std::uint32_t shader;
    RayResult ray;
  };
  struct Queue {
    std::vector<Fifo<Waiting>> lists;  // by shader, or one
    std::size_t size = 0;
  };

  std::size_t queue_for(const RayResult& ray);
  static Fifo<Waiting>* oldest(Queue& queue, std::size_t least);
  Waiting take_first(Queue& queue, Fifo<Waiting>& list);

  ShadingConfig::Distribute distribute_;
  bool sorted_;
  std::size_t lanes_;
  std::uint64_t seed_, order_ = 0;
  std::vector<Queue> queues_;
  std::vector<std::size_t> in_work_;  // by worker
  std::size_t turn_ = 0, size_ = 0;
};

}  // namespace carousel::ringbus::cycle
