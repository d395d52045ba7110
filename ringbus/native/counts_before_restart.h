#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/statistics/link_fault_counts.h"
#include "core/statistics/queue_use.h"
#include "core/types/workload.h"
#include "ringbus/native/native_parts.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// The counts of a run whose machine was built anew since a resource had stopped: those of the machine before, and the
/// work of the restart.
class CountsBeforeRestart {
 public:
  /// Keeps the counts of the machine, which is about to be built anew. What is under way in it is discarded.
  void keep(const NativeParts& parts);
  /// These rays begin again, so many seconds after the resource's last sign of life.
  void restart(const RayBatch& rays, double seconds);
  /// Adds them to the result, which has the counts of the machine since then.
  void add_to(RunResult& out) const;

 private:
  std::uint64_t packets_discarded_ = 0, slots_used_ = 0, slot_waits_ = 0;
  QueueUse completed_, groups_;
  std::vector<LinkFaultCounts> link_faults_;  // by link
  std::uint64_t rays_restarted_ = 0, paths_restarted_ = 0;
  double recovery_seconds_ = 0;
};

}  // namespace carousel::ringbus
