#pragma once

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/native/links/queue_link.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// The ring on worker threads and real queues; the clock is the wall. R resources and W shader workers are
/// shared out over the threads, each thread stepping its own in turn.
///
/// Runs `workload` (which must allow shader_workers(config) workers) to its end. Throws SimulationError when
/// something got stuck or was lost; exceptions of the workload pass through.
RunResult run_native(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                     const RunOptions& options);

/// As run_native(), with links that `links` makes in place of those of `topology.link.queue`; for queues of one's own,
/// as in run_native_on(make_queue_link<MyQueue>, ...).
RunResult run_native_on(const LinkMaker& links, const Config& config, const accel::Accel& accel, float scene_size,
                        Workload& workload, const RunOptions& options);

}  // namespace carousel::ringbus
