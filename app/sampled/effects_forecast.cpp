#include "app/sampled/effects_forecast.h"

#include <algorithm>

#include "accel/traverse/reference_tracer.h"
#include "core/types/wrapped_workload.h"
#include "report/text/ratio.h"

namespace carousel::app {

namespace {

constexpr std::uint64_t kSampledPaths = 2048;

/// Counts, at the hits that it passes on, the work of the effects by two plans: that of the inner workload and that of
/// `all`, which is asked about each hit and shades none.
class TwoPlans final : public WrappedWorkload {
 public:
  TwoPlans(Workload& inner, const Workload& all, const ShadingConfig& shading)
      : WrappedWorkload(inner),
        all_(all),
        lookup_(static_cast<std::uint64_t>(shading.cycles_per_lookup)),
        rate_(static_cast<std::uint64_t>(shading.products_per_cycle)) {}

  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& result : completed) {
      const ShadeWork few = inner_.extra_work(result), all = all_.extra_work(result);
      products_ += static_cast<std::int64_t>(all.products) - static_cast<std::int64_t>(few.products);
      cycles_ += static_cast<std::int64_t>(cycles_of(all)) - static_cast<std::int64_t>(cycles_of(few));
    }
    inner_.shade(worker, completed, out);
  }
  double products() const { return static_cast<double>(products_); }
  double cycles() const { return static_cast<double>(cycles_); }

 private:
  /// As the machine charges a shader worker (ringbus/cycle/shading/shade_costs.h).
  std::uint64_t cycles_of(const ShadeWork& work) const {
    return lookup_ * work.lookups + (rate_ == 0 ? 0 : (work.products + rate_ - 1) / rate_);
  }

  const Workload& all_;
  std::uint64_t lookup_, rate_;
  std::int64_t products_ = 0, cycles_ = 0;
};

}  // namespace

void foretell_effects(const Prepared& p, const RenderJob& job, report::Report& report) {
  const Config& config = p.config();
  const bool picture = config.workload.kind == WorkloadConfig::Kind::kRays;
  if (!picture || report.incomplete || !report.engine.cycles || !job.divisible() || job.first_rays() == 0) return;
  if (job.sample() != nullptr) return;       // a part of the frame, which is made longer by its fill and drain
  if (config.shading.program.any()) return;  // which takes its time for all effects at once
  if (config.shading.effects.choice != ShadingConfig::Effects::Choice::kAuto || !report.shading.utilisation) return;
  Config everything = config;
  everything.shading.effects = {ShadingConfig::Effects::Choice::kAll, {}};
  RenderJob sampled(p, config, job.first_hits());
  const RenderJob all(p, everything, job.first_hits());
  const shading::PathSample sample = sampled.draw(std::min(kSampledPaths, sampled.first_rays()), 1);
  sampled.set_sample(&sample);
  TwoPlans plans(sampled.workload(), all.workload(), config.shading);
  const accel::ReferenceRun run = accel::run_reference(p.accel, plans);
  if (run.rays == 0) return;

  report::EffectsSpared spared;
  spared.products_per_ray = plans.products() / static_cast<double>(run.rays);
  double more =
      std::max(0.0, plans.cycles()) / static_cast<double>(run.rays) * static_cast<double>(report.rays.completed);
  // A vector of several lanes takes as long as the longest of its rays.
  if (const auto& vectors = report.shading.vectors; vectors && vectors->counts.runs > 0)
    more *= report::ratio(vectors->counts.runs, vectors->counts.rays);
  const auto cycles = static_cast<double>(*report.engine.cycles);
  const double workers = std::max<double>(1, static_cast<double>(report.shading.workers));
  const double use = std::clamp(*report.shading.utilisation, 0.0, 1.0), each = more / workers;
  // Shaders that work beside other parts hide their time until they are the part that limits; shaders that are busy all
  // the time hide nothing. Between the two the forecast goes by their use with all effects.
  const double low = std::max(cycles, use * cycles + each), high = cycles + each;
  const double use_with_all = std::min(1.0, (use * cycles + each) / high);
  const double forecast = low + use_with_all * use_with_all * (high - low) / 2;
  spared.shader_cycles = static_cast<std::uint64_t>(more + 0.5);
  spared.low = static_cast<std::uint64_t>(low + 0.5);
  spared.high = static_cast<std::uint64_t>(high + 0.5);
  spared.cycles_with_all = static_cast<std::uint64_t>(forecast + 0.5);
  spared.fraction = forecast > 0 ? 1 - cycles / forecast : 0;
  report.effects.emplace().spared = spared;
}

void judge_forecast(report::Report& report) {
  if (!report.effects || !report.effects->spared || !report.shading.proof) return;
  const std::uint64_t measured = report.shading.proof->all.cycles.value_or(0);
  if (measured == 0) return;
  report::EffectsSpared& spared = *report.effects->spared;
  spared.measured = measured;
  spared.error = static_cast<double>(spared.cycles_with_all) / static_cast<double>(measured) - 1;
}

}  // namespace carousel::app
