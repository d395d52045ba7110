#include "app/frames/wear.h"

#include <algorithm>

#include "accel/builders/build.h"
#include "accel/builders/place_micromaps.h"
#include "accel/builders/refit.h"
#include "accel/traverse/reference_tracer.h"
#include "app/run/render_job.h"
#include "core/system/executor.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

namespace {

/// The tests of all rays of the frame, each traced by itself in `accel`.
std::uint64_t depth_first_tests(const Prepared& p, const accel::Accel& accel) {
  const RenderJob job(p);
  const IntersectionCounts tests = accel::run_reference(accel, job.workload()).tests;
  return tests.box + tests.triangle + tests.procedural;
}

}  // namespace

accel::Accel rebuild_beside(const Prepared& p, report::Frame& row) {
  accel::Accel rebuilt = accel::build(p.scene, p.config().bvh, *make_executor(p.threads), p.config().accuracy);
  rebuilt.any_hit = p.accel.any_hit;
  if (p.micromaps) accel::set_micromaps(rebuilt, *p.micromaps);
  row.surface_cost_rebuilt = accel::surface_cost(rebuilt);
  row.depth_first_tests = depth_first_tests(p, p.accel);
  row.depth_first_tests_rebuilt = depth_first_tests(p, rebuilt);
  return rebuilt;
}

void judge_wear(const Prepared& p, const accel::Accel& rebuilt, const std::stop_token& stop, report::Frame& row) {
  const double spared =
      static_cast<double>(*row.cycles) * (1 - report::ratio(*row.depth_first_tests_rebuilt, *row.depth_first_tests));
  const double more = static_cast<double>(*row.rebuild_cycles) - static_cast<double>(row.builder->cycles);
  row.rebuild_pays = false;
  if (spared <= more) return;
  Config config = p.config();
  config.collections.capacity =
      std::max(config.collections.capacity, ringbus::minimum_capacity(config, rebuilt.most_ways(), rebuilt.levels()));
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = stop;
  const RenderJob job(p);
  const ringbus::RunResult result = ringbus::run_cycle(config, rebuilt, p.scene_size(), job.workload(), options);
  row.rebuild_pays.reset();
  if (!result.complete) return;
  row.cycles_rebuilt = result.cycle->cycles;
  row.rebuild_pays = *row.rebuild_cycles + *row.cycles_rebuilt < row.builder->cycles + *row.cycles;
}

}  // namespace carousel::app
