#include "app/run/fault_cost.h"

#include <utility>

#include "app/host/log.h"
#include "app/run/ray_progress.h"
#include "app/run/render_job.h"
#include "ringbus/cycle/cycle_engine.h"

namespace carousel::app {

void compare_without_faults(const Prepared& prepared, std::stop_token stop, bool quiet, report::Report& report) {
  if (report.incomplete || !report.engine.cycles) return;
  Config sound = prepared.config();
  sound.faults = {};
  RenderJob job(prepared, sound);
  ringbus::RunOptions options;
  options.threads = prepared.threads;
  options.stop = std::move(stop);
  options.statistics = false;
  const Phase phase("run without faults");
  CountingWorkload counting(job.workload());
  const auto line = show_rays(options, counting, job.first_rays(), "without faults", quiet);
  const ringbus::RunResult result = ringbus::run_cycle(sound, prepared.accel, prepared.scene_size(), counting, options);
  if (!result.complete) {
    report.incomplete = true;
    return;
  }
  if (!report.faults) report.faults.emplace();
  report.faults->cycles_without = result.cycle->cycles;
  report.faults->cycles_lost =
      static_cast<std::int64_t>(*report.engine.cycles) - static_cast<std::int64_t>(result.cycle->cycles);
  report.faults->same_hits = job.hits_digest() == report.digest.hits && job.image_digest() == report.digest.image;
}

}  // namespace carousel::app
