#include "app/sampled/sampled_run.h"

#include <utility>

#include <fmt/format.h>

#include "app/host/log.h"
#include "app/run/ray_progress.h"
#include "report/text/number_text.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/sampling/sample_estimate.h"

namespace carousel::app {

namespace {

/// Calls `body` with each value of the report and that of the frame.
template <class Body>
void for_each(report::Sampled& to, const ringbus::FrameValues& from, const Body& body) {
  body(to.cycles_per_ray, from.cycles_per_ray);
  body(to.cycles, from.cycles);
  body(to.rays, from.rays);
  body(to.rays_per_kilocycle, from.rays_per_kilocycle);
  body(to.box_tests_per_ray, from.box_tests_per_ray);
  body(to.triangle_tests_per_ray, from.triangle_tests_per_ray);
  body(to.memory_bytes_per_ray, from.memory_bytes_per_ray);
  body(to.link_bytes_per_ray, from.link_bytes_per_ray);
  for (report::SampledUse& use : to.uses)
    for (const ringbus::ClassEstimate& other : from.uses)
      if (other.name == use.name) body(use.use, other.use);
}

}  // namespace

report::Sampled estimates(const Prepared& prepared, const RenderJob& job, const PlaceCensus& places,
                          const ringbus::RunResult& result, const ringbus::MemoryLog& memory) {
  const Config& config = prepared.config();
  const ringbus::cycle::ShapeMemory shapes(prepared.accel, config.accuracy, config.bvh, config.memory);
  const ringbus::FrameValues values = ringbus::estimate_frame(
      config, {result, memory, shapes.size_bytes(), job.first_rays(), job.frame_rays(), places.paths(), places.rays()});
  report::Sampled out{.paths = job.first_rays(),
                      .frame_paths = job.frame_rays(),
                      .strata = places.paths().size(),
                      .steady = values.steady,
                      .too_small = values.too_small};
  if (config.workload.kind == WorkloadConfig::Kind::kRays)
    out.picture = "the tiles that were drawn; the other pixels are black";
  for (const ringbus::ClassEstimate& use : values.uses) out.uses.push_back({.name = std::string(use.name)});
  for_each(out, values, [](report::SampledValue& to, const ringbus::Estimate& from) {
    to.estimate = from.value;
    to.low = from.low;
    to.high = from.high;
  });
  return out;
}

void audit(const Prepared& prepared, const RenderJob& job, std::stop_token stop, bool quiet, const NjPerRay& nj_per_ray,
           report::Report& report) {
  if (report.incomplete || !report.sampled) return;
  Config config = prepared.config();
  config.sampling = {};
  RenderJob whole(prepared, config, job.first_hits());
  ringbus::RunOptions options;
  options.threads = prepared.threads;
  options.stop = std::move(stop);
  Phase phase("run of the whole frame");
  CountingWorkload counting(whole.workload());
  const auto line = show_rays(options, counting, whole.first_rays(), "the whole frame", quiet);
  const ringbus::RunResult result =
      ringbus::run_cycle(config, prepared.accel, prepared.scene_size(), counting, options);
  if (!result.complete) {
    report.incomplete = true;
    return;
  }
  phase.result(fmt::format("{} rays, {} cycles", report::scaled(static_cast<double>(result.rays_completed)),
                           report::grouped(result.cycle->cycles)));
  report.host.audit_seconds = result.wall_seconds;
  const auto tell = [](report::SampledValue& to, double truth) {
    to.whole = truth;
    if (truth != 0) to.error = to.estimate / truth - 1;
  };
  for_each(*report.sampled, ringbus::exact_values(config, result),
           [&](report::SampledValue& to, const ringbus::Estimate& from) { tell(to, from.value); });
  if (report.sampled->nj_per_ray) tell(*report.sampled->nj_per_ray, nj_per_ray(whole, result));
}

}  // namespace carousel::app
