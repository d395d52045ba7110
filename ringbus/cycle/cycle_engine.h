#pragma once

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

}  // namespace carousel::ringbus
