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
#include "app/build_report/memory_report.h"
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
#include "app/run/memory_csv.h"
#include "app/run/ray_progress.h"
#include "app/run/render_job.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/run/memory_table.h"
#include "report/run/report_json.h"
#include "report/run/report_table.h"
#include "report/run/traffic_table.h"
#include "report/text/number_text.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/memory/memory_trace.h"
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
                            const InterruptScope& interrupt, bool quiet, const TraceFile* trace,
                            ringbus::MemoryLog* memory) {
  Phase phase("run");
  CountingWorkload counting(workload);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.samples = static_cast<std::size_t>(p.config().report.samples);
  if (trace != nullptr) options.timeline = trace->wanted();
  options.memory = memory;
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
  std::exception_ptr failure;
  try {
    const Phase phase("files");
    write_files();
    output.commit();
  } catch (const FileError&) {
    failure = std::current_exception();
  }
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

/// Plays requests to the memory alone.
int run_memory_command(const RunArguments& arguments, const Prepared& p, const InterruptScope& interrupt,
                       OutputFolder& output) {
  const ringbus::MemoryLog requests = read_memory_csv(find_beside(p.config_folder, p.config().workload.memory_trace));
  const report::Report report = memory_report(p, ringbus::run_memory_trace(p.config(), requests, interrupt.token()));
  finish(arguments, report, report::memory_table(report), output, [&] {
    write_file(output.staging() / "config.resolved.yaml", resolved_yaml(p.config()));
    write_report(output.staging(), arguments, report);
  });
  return verdict(report, interrupt.status());
}

/// A workload without rays has no hits that could be written.
void require_no_hits(const RunArguments& arguments, std::string_view workload) {
  const auto refuse = [&](bool wanted, const char* option) {
    if (!wanted) return;
    throw ConfigError(
        {{{}, option, fmt::format("{} no rays; expected workload: rays, or a run without this option", workload)}});
  };
  refuse(arguments.hits, "--hits");
  refuse(!arguments.dump_rays.empty(), "--dump-rays");
  refuse(!arguments.dump_memory.empty(), "--dump-memory");
  refuse(!arguments.trace.file.empty(), "--trace");
}

/// Only a simulated machine has a memory.
void require_memory(const RunArguments& arguments, const Config& config) {
  if (!arguments.dump_memory.empty() && config.engine.kind != EngineKind::kCycle)
    throw ConfigError({{{},
                        "--dump-memory",
                        "the native engine has no simulated memory; expected engine.kind: cycle, or a run without this "
                        "option"}});
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
    output.emplace(out_folder(arguments), config, arguments.force);  // before any work that could be lost
  });
  if (!p.config().vary.empty())
    spdlog::warn("run ignores vary, which is for sweeps, and uses the values of the other keys");
  if (p.config().workload.kind == WorkloadConfig::Kind::kTraffic) {
    require_no_hits(arguments, "synthetic traffic has");
    return run_traffic_command(arguments, p, interrupt, *output);
  }
  if (p.config().workload.kind == WorkloadConfig::Kind::kMemoryTrace) {
    require_no_hits(arguments, "memory requests have");
    return run_memory_command(arguments, p, interrupt, *output);
  }
  require_memory(arguments, p.config());

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
  ringbus::MemoryLog memory;
  const ringbus::RunResult result = simulate(p, job, workload, interrupt, arguments.quiet, trace ? &*trace : nullptr,
                                             arguments.dump_memory.empty() ? nullptr : &memory);
  if (!arguments.dump_memory.empty()) write_memory_csv(arguments.dump_memory, memory);
  if (trace) write_trace(*trace, arguments.trace, result);
  report::Report report = build_report(p, job, result, verifying ? &*verifying : nullptr);
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
