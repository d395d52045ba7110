#include "app/run/effects_proof.h"

#include <algorithm>
#include <array>
#include <vector>

#include "accel/traverse/reference_tracer.h"
#include "app/host/cpu_time.h"
#include "app/host/log.h"
#include "app/run/memory_need.h"
#include "app/run/ray_progress.h"
#include "app/run/render_job.h"
#include "core/types/wrapped_workload.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/native/native_engine.h"
#include "shading/effects/effects_plan.h"

namespace carousel::app {

namespace {

constexpr std::uint64_t kTimedPaths = 16384;
constexpr int kPairs = 7;

/// Adds up the work of the effects at the hits that it passes on.
class WorkCount final : public WrappedWorkload {
 public:
  explicit WorkCount(Workload& inner) : WrappedWorkload(inner) {}
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& result : completed) products_ += inner_.extra_work(result).products;
    inner_.shade(worker, completed, out);
  }
  std::uint64_t products() const { return products_; }

 private:
  std::uint64_t products_ = 0;
};

/// CPU time of the sample's paths on this thread, depth first.
double sample_seconds(const Prepared& p, const shading::PathSample& sample) {
  RenderJob job(p);
  job.set_sample(&sample);
  const double start = thread_cpu_seconds();
  accel::run_reference(p.accel, job.workload());
  return thread_cpu_seconds() - start;
}

template <class Times>
Times spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

/// The counts of one way; `cycles` of its frame.
report::EffectsUse use_of(const Prepared& p, const shading::PathSample& sample, std::optional<std::uint64_t> cycles) {
  report::EffectsUse use;
  RenderJob job(p);
  job.set_sample(&sample);
  WorkCount counted(job.workload());
  const accel::ReferenceRun run = accel::run_reference(p.accel, counted);
  use.products_per_ray = report::ratio(counted.products(), run.rays);
  use.path_state_bytes = std::min(paths_in_flight(p.config()), job.first_rays()) *
                         shading::plan_effects(p.scene, p.config()).path_state_bytes();
  for (const scene::Image& image : p.scene.images) use.texture_bytes += image.rgba.size();
  use.cycles = cycles;
  return use;
}

void time_both(const Prepared& by_demand, const Prepared& all, const shading::PathSample& sample,
               report::EffectsProof& proof) {
  std::array<std::vector<double>, 2> times;
  std::vector<double> ratios;
  for (int pair = 0; pair < kPairs; ++pair) {
    std::array<double, 2> both{};
    for (const int turn : {pair % 2, 1 - pair % 2})
      both[static_cast<std::size_t>(turn)] = sample_seconds(turn == 0 ? by_demand : all, sample);
    for (std::size_t i = 0; i < 2; ++i) times[i].push_back(both[i]);
    ratios.push_back(report::ratio(both[1], both[0]));
  }
  proof.by_demand.seconds = spread<report::PairedTimes>(times[0]);
  proof.all.seconds = spread<report::PairedTimes>(times[1]);
  proof.time_ratio = spread<report::PairedRatio>(ratios);
  proof.repetitions = kPairs;
}

}  // namespace

void prove_effects(const ConfigArguments& arguments, const Prepared& by_demand, const InterruptScope& interrupt,
                   bool quiet, report::Report& report) {
  if (report.incomplete || !report.tests) return;
  ConfigArguments with_all = arguments;
  with_all.sets.insert(with_all.sets.end(), {"verify=none", "shading.effects=all"});
  const Prepared p = prepare(with_all, {.force = true}, false);
  RenderJob job(p);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  const Phase phase("run with all effects");
  CountingWorkload counting(job.workload());
  auto line = show_rays(options, counting, job.first_rays(), "with all effects", quiet);
  const ringbus::RunResult result = run(p.config(), p.accel, p.scene_size(), counting, options);
  line.reset();
  if (!result.complete) {
    report.incomplete = true;
    return;
  }
  report::EffectsProof proof;
  proof.same_hits = job.hits_digest() == report.digest.hits;
  proof.same_image = job.image_digest() == report.digest.image;
  const shading::PathSample sample = job.draw(std::min(kTimedPaths, job.first_rays()), 1);
  proof.paths = sample.count();
  proof.by_demand = use_of(by_demand, sample, report.engine.cycles);
  proof.all = use_of(p, sample, result.cycle ? std::optional(result.cycle->cycles) : std::nullopt);
  time_both(by_demand, p, sample, proof);
  report.shading.proof = proof;
}

}  // namespace carousel::app
