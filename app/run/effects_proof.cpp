#include "app/run/effects_proof.h"

#include "app/run/render_job.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/native/native_engine.h"

namespace carousel::app {

namespace {

std::uint64_t tests_of(const ringbus::RunResult& result) {
  IntersectionCounts sum;
  for (const ringbus::ResourceStatistics& resource : result.resources) sum += resource.tests;
  return sum.tests();
}

std::int64_t difference(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(a) - static_cast<std::int64_t>(b);
}

}  // namespace

void prove_effects(const ConfigArguments& arguments, const InterruptScope& interrupt, report::Report& report) {
  if (report.incomplete || !report.tests) return;
  ConfigArguments with_all = arguments;
  with_all.sets.insert(with_all.sets.end(), {"verify=none", "shading.effects=all"});
  const Prepared p = prepare(with_all, {.force = true}, false);
  RenderJob job(p);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  const ringbus::RunResult result = run(p.config(), p.accel, p.scene_size(), job.workload(), options);
  if (!result.complete) {
    report.incomplete = true;
    return;
  }
  report::EffectsProof& proof = report.shading.proof.emplace();
  proof.same_hits = job.hits_digest() == report.digest.hits;
  proof.same_image = job.image_digest() == report.digest.image;
  proof.rays_spared = difference(result.rays_completed, report.rays.completed);
  proof.tests_spared = difference(tests_of(result), report.tests->counts.tests());
  if (result.cycle && report.engine.cycles)
    proof.cycles_spared = difference(result.cycle->cycles, *report.engine.cycles);
  report.host.all_effects_seconds = result.wall_seconds;
}

}  // namespace carousel::app
