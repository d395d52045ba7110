#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/types/workload.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/queues/completed_queue.h"
#include "ringbus/rays/ray_control.h"
#include "ringbus/rays/ray_sorter.h"

namespace carousel::ringbus {

/// Counts the rays there are and knows whether more will come: the one count that termination needs. A ray counts from
/// before it is made until it has been shaded and its children are counted.
struct RayCount {
  std::atomic<std::int64_t> outstanding{0};
  std::atomic<std::uint64_t> emitted{0}, completed{0};
  std::atomic<bool> source_finished{false};

  bool done() const {
    // Acquire: pairs with the release in ShaderWorker::generate; a thread that sees the end of the source also sees
    // the count of the last rays that came out of it.
    return source_finished.load(std::memory_order_acquire) && outstanding.load(std::memory_order_acquire) == 0;
  }
};

/// Takes completed rays of any resource, shades them, and hands the new rays to ray control. With nothing to shade and
/// slots to spare it asks the workload for rays of its own. One thread steps it.
///
/// With rays.sort: cells it hands over as many rays at a time as it can have: those of all completed rays that there
/// are, and of its own at least a half of the slots.
class ShaderWorker {
 public:
  /// `slots`: of the whole machine, which `workers` workers fill. `ledger` is told of every ray; null: none is kept.
  ShaderWorker(WorkerId id, RayControl& control, CompletedQueue& completed, Workload& workload, RayCount& count,
               std::int64_t slots, std::int64_t workers, RaySort sort, OutstandingRays* ledger = nullptr);

  /// Returns whether anything was done.
  bool step();

 private:
  bool shade();
  bool generate();
  void hand_over();
  bool submit_gathered();

  WorkerId id_;
  RayControl& control_;
  CompletedQueue& completed_;
  Workload& workload_;
  RayCount& count_;
  OutstandingRays* ledger_;
  std::int64_t slots_, workers_;
  std::optional<RaySorter> sorter_;
  RayBatch rays_;
  RayBatch gathered_;  // to be sorted
};

}  // namespace carousel::ringbus
