#include "app/commands/run_command.h"

#include <cstdio>
#include <filesystem>
#include <optional>

#include <spdlog/spdlog.h>

#include "accel/planes/cull_planes.h"
#include "accel/traverse/verifying_workload.h"
#include "app/build_report/build_report.h"
#include "app/build_report/traffic_report.h"
#include "app/build_report/verdict.h"
#include "app/commands/report_command.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/run/bottleneck.h"
#include "app/run/counting_workload.h"
#include "app/run/effects_proof.h"
#include "app/run/fault_cost.h"
#include "app/run/hit_recorder.h"
#include "app/run/render_job.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/run/report_json.h"
#include "report/run/report_table.h"
#include "report/run/traffic_table.h"
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

ringbus::RunResult simulate(const Prepared& p, const RenderJob& job, Workload& workload,
                            const InterruptScope& interrupt, bool quiet, const TraceFile* trace) {
  CountingWorkload counting(workload);
  std::optional<report::ProgressLine> line;
  if (!quiet) line.emplace(stderr);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.samples = static_cast<std::size_t>(p.config().report.samples);
  if (trace != nullptr) options.timeline = trace->wanted();
  options.progress = [&](std::uint64_t completed) {
    if (line) line->update(report::ratio(counting.generated(), job.first_rays()), completed);
  };
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  return run(p.config(), p.accel, p.scene_size(), counting, options);
}

void print_report(const RunArguments& arguments, const report::Report& report, const std::string& table,
                  const std::filesystem::path& folder) {
  if (arguments.json)
    print_result(report::json_text(report::report_json(report)) + "\n");
  else if (!arguments.quiet)
    print_result(table + "files        " + folder.string() + "\n");
}

/// The report is written last, so that the files it names exist before it does; the page shows the picture beside it.
void write_report(const std::filesystem::path& folder, const RunArguments& arguments, const report::Report& report) {
  const nlohmann::ordered_json json = report::report_json(report);
  if (!arguments.no_html) write_file(folder / "report.html", run_page_of(json, folder));
  write_file(folder / "report.json", report::json_text(json) + "\n");
}

/// Simulates the network alone, without rays.
int run_traffic_command(const RunArguments& arguments, const Prepared& p, const InterruptScope& interrupt) {
  std::optional<report::ProgressLine> line;
  if (!arguments.quiet) line.emplace(stderr);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.progress = [&](std::uint64_t packets) {
    if (line) line->update(report::ratio(packets, p.config().workload.traffic.packets), packets);
  };
  const ringbus::TrafficResult result = ringbus::run_traffic(p.config(), options);
  line.reset();
  const report::Report report = traffic_report(p, result);
  const std::filesystem::path folder = out_folder(arguments);
  write_file(folder / "config.resolved.yaml", resolved_yaml(p.config()));
  write_report(folder, arguments, report);
  print_report(arguments, report, report::traffic_table(report), folder);
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
  const Prepared p = prepare(arguments, {.force = arguments.force}, keep_hits);
  if (!p.config().vary.empty())
    spdlog::warn("run ignores vary, which is for sweeps, and uses the values of the other keys");
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) {
    require_no_hits(arguments);
    return run_traffic_command(arguments, p, interrupt);
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
  Workload& workload = verifying ? *verifying : job.workload();

  std::optional<TraceFile> trace;
  if (!arguments.trace.file.empty()) trace.emplace(arguments.trace, p.config().engine.kind == EngineKind::kNative);
  const ringbus::RunResult result = simulate(p, job, workload, interrupt, arguments.quiet, trace ? &*trace : nullptr);
  if (trace) write_trace(*trace, arguments.trace, result);
  report::Report report = build_report(p, job, result, verifying ? &*verifying : nullptr);
  if (result.cycle) {
    report.bound = bound_of(result);
    if (p.config().engine.what_if) {
      report.bottleneck = find_bottleneck(p, job, result, interrupt.token(), arguments.quiet);
      report.incomplete |= !report.bottleneck->complete;
    }
  }
  if (p.config().faults.compare) compare_without_faults(p, interrupt.token(), report);
  if (p.config().verify == Verify::kEffects) prove_effects(arguments, p, interrupt, report);
  const std::filesystem::path folder = out_folder(arguments);
  write_files(folder, arguments, p, job, report, recorder ? &*recorder : nullptr);

  print_report(arguments, report, report::report_table(report), folder);
  return verdict(report, interrupt.status());
}

}  // namespace carousel::app
