#include "app/build_report/experiment.h"

#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "accel/builders/build.h"
#include "accel/traverse/hit_oracle.h"
#include "accel/traverse/verifying_workload.h"
#include "app/area/machine_area.h"
#include "app/build_report/build_report.h"
#include "app/build_report/energy_report.h"
#include "app/build_report/memory_report.h"
#include "app/build_report/ring_sections.h"
#include "app/build_report/traffic_report.h"
#include "app/energy/power_meter.h"
#include "app/host/log.h"
#include "app/raster/raster_unit.h"
#include "app/run/bottleneck.h"
#include "app/run/counting_workload.h"
#include "app/run/effects_proof.h"
#include "app/run/fault_cost.h"
#include "app/run/machine_log.h"
#include "app/run/memory_need.h"
#include "app/run/ray_census.h"
#include "app/run/ray_progress.h"
#include "app/sampled/effects_forecast.h"
#include "app/sampled/sampled_run.h"
#include "app/trace/heat_map.h"
#include "app/trace/memory_csv.h"
#include "core/config/graph/ring.h"
#include "core/system/executor.h"
#include "report/text/number_text.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/memory/memory_trace.h"
#include "ringbus/cycle/traffic/ring_engine.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/results/run_features.h"
#include "ringbus/time/machine_clocks.h"

namespace carousel::app {

namespace {

/// The result of a run in one line, with the faults that happened on request.
std::string run_text(const Config& config, const ringbus::RunResult& result) {
  std::string out = fmt::format("{} engine, {} rays, {} threads", enum_name(config.engine.kind),
                                report::scaled(double(result.rays_completed)), result.threads);
  if (result.cycle) out += fmt::format(", {} cycles", report::grouped(result.cycle->cycles));
  if (result.rays_restarted > 0)
    out += fmt::format("; a resource stopped: {} rays restarted, {} packets discarded", result.rays_restarted,
                       result.packets_discarded);
  LinkFaultCounts faults;
  for (const ringbus::LinkResult& link : result.links) faults += link.faults;
  for (const auto& counter : LinkFaultCounts::counters())
    if (const std::uint64_t count = counter.value(faults); count > 0)
      out += fmt::format("; {} {} {}", count, counter.unit, counter.name);
  if (result.slot_waits > 0) spdlog::debug("run: new rays waited {} times for free slots", result.slot_waits);
  return out + (result.complete ? "" : "; stopped early");
}

ringbus::RunResult simulate(const Prepared& p, const RenderJob& job, Workload& workload,
                            const InterruptScope& interrupt, bool quiet, const TraceFile* trace,
                            ringbus::MemoryLog* memory, std::span<ringbus::PixelCost> heat, SeriesFrame* frame,
                            PowerMeter* power) {
  log_machine(p);
  Phase phase("run");
  CountingWorkload counting(workload);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.samples = static_cast<std::size_t>(p.config().report.samples);
  if (trace != nullptr) options.timeline = trace->wanted();
  options.memory = memory;
  options.meter = power;
  options.ray_times = true;
  options.heat = heat;
  if (frame != nullptr) {
    frame->began = std::move(frame->cached);
    options.warm = {.start = &frame->began};
  }
  options.transport = job.ranks();
  if (job.ranks() != nullptr) {
    options.samples = 0;  // their clocks differ
    options.scene_bytes = scene_bytes(p.scene);
  }
  const auto line = show_rays(options, counting, job.first_rays(), "", quiet);
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  ringbus::RunResult result = run(p.config(), p.accel, p.scene_size(), counting, options);
  if (power != nullptr && result.series) power->add_rows(*result.series);
  phase.result(run_text(p.config(), result));
  if (frame != nullptr && result.cycle) frame->cached = result.cycle->cached_lines;
  return result;
}

/// A signal to one rank ends all of them, with its status.
void share_signal(ringbus::Transport& ranks) {
  for (const std::string& number : ranks.gather(std::to_string(interrupting_signal()))) adopt_signal(std::stoi(number));
}

void write_trace(TraceFile& trace, const ringbus::RunResult& result) {
  const TraceFile::Written written =
      trace.write(*result.timeline, result.series ? &*result.series : nullptr, result.complete);
  if (written.left > 1)
    spdlog::warn(
        "{} has one of about {} packets, and no tracks of units, since all would be more than the events of "
        "--trace-events; --trace-window shows all of a part",
        trace.name(), report::grouped(written.left));
  if (written.cut)
    spdlog::warn(
        "{} has {} events and ends after {} of the time; --trace-sample {}, --trace-window or --trace-events chooses",
        trace.name(), report::grouped(written.events), report::percent(written.reached), written.every);
}

void find_limits(const Prepared& p, const RenderJob& job, const ringbus::RunResult& result, const SeriesFrame* frame,
                 const InterruptScope& interrupt, bool quiet, report::Report& report) {
  report.bound = bound_of(result);
  if (!p.config().engine.what_if || job.sample() != nullptr || !job.divisible()) return;
  Phase phase("search");
  // The rays of a list do not depend on a seed.
  const bool seeded = p.config().workload.kind == WorkloadConfig::Kind::kRays;
  const ringbus::SearchedRun run{result, job.first_rays(), frame != nullptr ? &frame->began : nullptr,
                                 seeded ? kNoiseSeeds : 0};
  report.bottleneck = find_bottleneck(p, job, run, interrupt.token(), quiet, report.cycle_noise);
  report.incomplete |= !report.bottleneck->complete;
  phase.result(fmt::format("{} classes relaxed for {} rays each; scene, structure and first hits are those of the run",
                           report.bottleneck->gains.size(), report.bottleneck->rays));
}

report::Report run_network(const Prepared& p, const InterruptScope& interrupt, bool quiet) {
  std::optional<report::ProgressLine> line;
  if (!quiet) line.emplace(stderr);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.progress = [&](std::uint64_t packets) {
    if (line) line->update(report::ratio(packets, p.config().workload.traffic.packets), packets, "packets");
  };
  const Config& c = p.config();
  const auto ring = config::lone_stop_ring_entry(c.topology);
  if (!ring) return traffic_report(p, ringbus::run_traffic(c, options));
  const auto clock =
      ringbus::MachineClocks(c.engine.clock_mhz, c.clocks.synchroniser_cycles).from_core(c.topology.links[*ring].mhz);
  return traffic_report(p, ringbus::run_ring_traffic(c.topology, c.workload.traffic, clock, c.image.seed, options));
}

report::Report play_requests(const Prepared& p, const InterruptScope& interrupt) {
  const ringbus::MemoryLog requests = read_memory_csv(find_beside(p.config_folder, p.config().workload.memory_trace));
  return memory_report(
      p, ringbus::run_memory_trace(p.config().memory, p.config().engine.clock_mhz, requests, interrupt.token()));
}

}  // namespace

report::Report run_rays(const ConfigArguments& arguments, const Prepared& p, RenderJob& job,
                        const InterruptScope& interrupt, bool quiet, TraceFile* trace, ringbus::MemoryLog* memory,
                        std::span<ringbus::PixelCost> heat, SeriesFrame* frame) {
  std::optional<accel::HitOracle> oracle;
  std::optional<accel::VerifyingWorkload> verifying;
  if (p.config().verify == Verify::kReference) {
    oracle.emplace(p.scene, p.config().accuracy, p.accel.any_hit);
    verifying.emplace(job.workload(), *oracle);
    verifying->set_nearest(static_cast<std::size_t>(p.config().rays.query.nearest));
    if (p.nearest_hits) p.nearest_hits->judge_by(&*verifying);
  }
  SeriesFrame alone{.cached = {}, .began = {}, .last = true};
  std::optional<RasterPass> pass;
  if (p.config().engine.kind == EngineKind::kCycle) {
    pass = rasterise_in_machine(p, job, interrupt.token(), (frame != nullptr ? frame : &alone)->cached);
    if (pass && frame == nullptr) frame = &alone;  // its lines are there when the rays begin
  }
  const bool picture = p.config().workload.kind == WorkloadConfig::Kind::kRays;
  const auto rays_a_path = static_cast<std::uint64_t>(picture ? 2 * p.config().image.max_depth : 1);
  RayCensus census(verifying ? static_cast<Workload&>(*verifying) : job.workload(),
                   static_cast<std::size_t>(shader_workers(p.config())),
                   RayCensus::one_in(job.frame_rays() * rays_a_path));
  std::optional<PlaceCensus> places;
  ringbus::MemoryLog requests;
  if (job.sample() != nullptr) {
    places.emplace(census, job);
    if (memory == nullptr) memory = &requests;
  }
  std::optional<PowerMeter> power;
  if (p.config().engine.kind == EngineKind::kCycle && p.config().energy.profile != CostProfile::kNone)
    power.emplace(p.config(), machine_area(p.config(), ringbus::scene_facts(p.accel)).link_mm,
                  p.config().engine.clock_mhz);
  const ringbus::RunResult result = simulate(p, job, places ? static_cast<Workload&>(*places) : census, interrupt,
                                             quiet, trace, memory, heat, frame, power ? &*power : nullptr);
  if (p.nearest_hits) p.nearest_hits->judge_by(nullptr);
  if (job.ranks() != nullptr) {
    share_signal(*job.ranks());
    job.join();
    census.join(*job.ranks());
    if (job.ranks()->rank() != 0) {
      report::Report nothing;
      nothing.incomplete = !result.complete;
      return nothing;
    }
  }
  if (trace != nullptr) write_trace(*trace, result);
  report::Report report = build_report(p, job, result, verifying ? &*verifying : nullptr);
  if (pass) {
    report.raster_unit = pass->cost;
    report.raster_unit->limits = pass->cost.cycles > report.engine.cycles.value_or(0);
    report.incomplete |= !pass->complete;
  }
  if (power && report.energy) report.energy->peak = power->peak();
  add_census(report, census, p.accel);
  if (result.complete && !heat.empty())
    report.heat = heat_section(heat, static_cast<std::uint32_t>(p.config().image.width));
  report.host.draw_seconds = job.draw_seconds();
  if (places && result.complete) {
    report.sampled = estimates(p, job, *places, result, *memory);
    // The pass is that of the whole frame.
    if (pass) report.raster_unit->limits = static_cast<double>(pass->cost.cycles) > report.sampled->cycles.estimate;
    add_sampled_energy(report, p.config());
  }
  if (result.cycle) foretell_effects(p, job, report);
  if (result.cycle && (frame == nullptr || frame->last)) find_limits(p, job, result, frame, interrupt, quiet, report);
  if (p.config().faults.compare) compare_without_faults(p, interrupt.token(), quiet, report);
  if (p.config().verify == Verify::kEffects) prove_effects(arguments, p, interrupt, quiet, report);
  judge_forecast(report);
  return report;
}

report::Report run_without_rays(const Prepared& p, const InterruptScope& interrupt, bool quiet) {
  return p.config().workload.kind == WorkloadConfig::Kind::kTraffic ? run_network(p, interrupt, quiet)
                                                                    : play_requests(p, interrupt);
}

}  // namespace carousel::app
