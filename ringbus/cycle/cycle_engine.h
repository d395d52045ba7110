#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// The ring under virtual time: deterministic, the same for any number of threads. See ringbus/cycle/.
///
/// Runs `workload` to its end; it is called from one thread at a time, as worker 0. Throws SimulationError when the
/// machine gets stuck, with who waits for whom; exceptions of the workload pass through.
RunResult run_cycle(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                    const RunOptions& options);

/// A run of the machine that goes on in parts.
class CycleSimulation {
 public:
  virtual ~CycleSimulation() = default;

  /// Goes on until so many rays are completed, or a few more, or all. Returns true at the end of the workload. The
  /// parts that a run is cut into change nothing but the places of the samples of its progress.
  virtual bool run_until(std::uint64_t completed) = 0;
  /// So far; the last sample is that of the end of the last part.
  virtual const std::vector<cycle::ProgressSample>& progress() const = 0;
  /// The result so far. It may be asked for once, and the run cannot go on after it.
  virtual RunResult result() = 0;
};

/// As run_cycle, but nothing runs yet. Keeps references to its arguments.
std::unique_ptr<CycleSimulation> begin_cycle(const Config& config, const accel::Accel& accel, float scene_size,
                                             Workload& workload, const RunOptions& options);

}  // namespace carousel::ringbus
