#include "app/commands/run_command.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "accel/planes/cull_planes.h"
#include "accel/traverse/verifying_workload.h"
#include "app/build_report/build_report.h"
#include "app/build_report/ring_sections.h"
#include "app/build_report/traffic_report.h"
#include "app/build_report/verdict.h"
#include "app/commands/report_command.h"
#include "app/host/interrupt.h"
#include "app/host/log.h"
#include "app/host/output.h"
#include "app/host/output_folder.h"
#include "app/run/bottleneck.h"
#include "app/run/counting_workload.h"
#include "app/run/effects_proof.h"
#include "app/run/fault_cost.h"
#include "app/run/hit_recorder.h"
#include "app/run/machine_log.h"
#include "app/run/ray_census.h"
#include "app/run/ray_progress.h"
#include "app/run/render_job.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/run/report_json.h"
#include "report/run/report_table.h"
#include "report/run/traffic_table.h"
#include "report/text/number_text.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/native/native_engine.h"

namespace carousel::app {

namespace {

std::filesystem::path out_folder(const RunArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  return std::filesystem::path("out") / std::filesystem::path(arguments.config).stem();
}

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
                            const InterruptScope& interrupt, bool quiet, const TraceFile* trace) {
  log_machine(p);
  Phase phase("run");
  CountingWorkload counting(workload);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.samples = static_cast<std::size_t>(p.config().report.samples);
  if (trace != nullptr) options.timeline = trace->wanted();
  const auto line = show_rays(options, counting, job.first_rays(), "", quiet);
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  ringbus::RunResult result = run(p.config(), p.accel, p.scene_size(), counting, options);
  phase.result(run_text(p.config(), result));
  return result;
}

void print_report(const RunArguments& arguments, const report::Report& report, const std::string& table,
                  const std::string& files) {
  if (arguments.json)
    print_result(report::json_text(report::report_json(report)) + "\n");
  else if (!arguments.quiet)
    print_text(table + "files        " + files + "\n");
}

/// Makes the files of a run appear, and prints its result: also where the files cannot be written, which is an error
/// after that.
template <class WriteFiles>
void finish(const RunArguments& arguments, const report::Report& report, const std::string& table, OutputFolder& output,
            const WriteFiles& write_files) {
  const std::exception_ptr failure = output.write([&](const std::filesystem::path&) {
    const Phase phase("files");
    write_files();
  });
  print_report(arguments, report, table, failure ? "none, they cannot be written" : output.folder().string());
  if (failure) std::rethrow_exception(failure);
}

/// The report is written last, so that the files it names exist before it does; the page shows the picture beside it.
void write_report(const std::filesystem::path& folder, const RunArguments& arguments, const report::Report& report) {
  const nlohmann::ordered_json json = report::report_json(report);
  if (!arguments.no_html) write_file(folder / "report.html", run_page_of(json, folder));
  write_file(folder / "report.json", report::json_text(json) + "\n");
}

/// Simulates the network alone, without rays.
int run_traffic_command(const RunArguments& arguments, const Prepared& p, const InterruptScope& interrupt,
                        OutputFolder& output) {
  std::optional<report::ProgressLine> line;
  if (!arguments.quiet) line.emplace(stderr);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.progress = [&](std::uint64_t packets) {
    if (line) line->update(report::ratio(packets, p.config().workload.traffic.packets), packets, "packets");
  };
  const ringbus::TrafficResult result = ringbus::run_traffic(p.config(), options);
  line.reset();
  const report::Report report = traffic_report(p, result);
  finish(arguments, report, report::traffic_table(report), output, [&] {
    write_file(output.staging() / "config.resolved.yaml", resolved_yaml(p.config()));
    write_report(output.staging(), arguments, report);
  });
  return verdict(report, interrupt.status());
}

/// Synthetic traffic has no rays whose hits could be written.
void require_no_hits(const RunArguments& arguments) {
  constexpr const char* kMessage =
      "synthetic traffic has no rays; expected workload: rays, or a run without this option";
  if (arguments.hits) throw ConfigError({{{}, "--hits", kMessage}});
  if (!arguments.dump_rays.empty()) throw ConfigError({{{}, "--dump-rays", kMessage}});
  if (!arguments.trace.file.empty()) throw ConfigError({{{}, "--trace", kMessage}});
}

void write_trace(TraceFile& trace, const TraceArguments& arguments, const ringbus::RunResult& result) {
  const TraceFile::Written written = trace.write(*result.timeline, result.series ? &*result.series : nullptr);
  if (written.cut)
    spdlog::warn("{} has {} events and ends before the run; --trace-window, --trace-sample and --trace-events choose",
                 arguments.file, written.events);
}

void write_files(const std::filesystem::path& folder, const RunArguments& arguments, const Prepared& p,
                 const RenderJob& job, const report::Report& report, HitRecorder* recorder) {
  write_file(folder / "config.resolved.yaml", resolved_yaml(p.config()));
  job.write_images(folder);
  if (recorder) {
    const std::vector<report::HitRow> rows = recorder->take();
    if (arguments.hits) report::write_hits_csv(folder / "hits.csv", rows);
    if (!arguments.dump_rays.empty()) report::write_rays_csv(arguments.dump_rays, rows);
  }
  write_report(folder, arguments, report);
}

}  // namespace

int run_command(const RunArguments& arguments) {
  const InterruptScope interrupt;
  const bool keep_hits = arguments.hits || !arguments.dump_rays.empty();
  std::optional<OutputFolder> output;
  const Prepared p = prepare(arguments, {.force = arguments.force}, keep_hits, [&](const Config& config) {
    output.emplace(out_folder(arguments), &config, arguments.force,
                   Results::kRun);  // before any work that could be lost
  });
  if (!p.config().vary.empty())
    spdlog::warn("run ignores vary, which is for sweeps, and uses the values of the other keys");
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) {
    require_no_hits(arguments);
    return run_traffic_command(arguments, p, interrupt, *output);
  }

  RenderJob job(p);
  std::optional<HitRecorder> recorder;
  if (keep_hits) job.set_recorder(&recorder.emplace(static_cast<std::size_t>(shader_workers(p.config()))));
  std::optional<accel::VerifyingWorkload> verifying;
  std::optional<accel::Accel> plain;  // planes and spheres are verified as well
  if (p.config().verify == Verify::kReference) {
    if (!accel::is_plain(p.accel)) plain = accel::plain_copy(p.accel);
    verifying.emplace(job.workload(), plain ? *plain : p.accel);
  }
  const bool picture = p.config().workload.kind == WorkloadConfig::Kind::kRays;
  const auto rays_a_path = static_cast<std::uint64_t>(picture ? 2 * p.config().image.max_depth : 1);
  RayCensus census(verifying ? static_cast<Workload&>(*verifying) : job.workload(),
                   static_cast<std::size_t>(shader_workers(p.config())),
                   RayCensus::one_in(job.first_rays() * rays_a_path));

  std::optional<TraceFile> trace;
  if (!arguments.trace.file.empty()) trace.emplace(arguments.trace, p.config().engine.kind == EngineKind::kNative);
  const ringbus::RunResult result = simulate(p, job, census, interrupt, arguments.quiet, trace ? &*trace : nullptr);
  if (trace) write_trace(*trace, arguments.trace, result);
  report::Report report = build_report(p, job, result, verifying ? &*verifying : nullptr);
  add_census(report, census, p.accel);
  if (result.cycle) {
    report.bound = bound_of(result);
    if (p.config().engine.what_if) {
      Phase phase("search");
      report.bottleneck = find_bottleneck(p, job, result, interrupt.token(), arguments.quiet);
      report.incomplete |= !report.bottleneck->complete;
      phase.result(
          fmt::format("{} classes relaxed for {} rays each; scene, structure and first hits are those of the run",
                      report.bottleneck->gains.size(), report.bottleneck->rays));
    }
  }
  if (p.config().faults.compare) compare_without_faults(p, interrupt.token(), arguments.quiet, report);
  if (p.config().verify == Verify::kEffects) prove_effects(arguments, p, interrupt, arguments.quiet, report);
  finish(arguments, report, report::report_table(report), *output,
         [&] { write_files(output->staging(), arguments, p, job, report, recorder ? &*recorder : nullptr); });
  return verdict(report, interrupt.status());
}

}  // namespace carousel::app
