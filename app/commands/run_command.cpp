#include "app/commands/run_command.h"

#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "accel/builders/file/write_trees.h"
#include "app/area/machine_area.h"
#include "app/area_search/area_search.h"
#include "app/build_report/build_report.h"
#include "app/build_report/experiment.h"
#include "app/build_report/verdict.h"
#include "app/commands/run_outputs.h"
#include "app/frames/frame_series.h"
#include "app/host/interrupt.h"
#include "app/host/log.h"
#include "app/host/output.h"
#include "app/host/rank_scope.h"
#include "app/host/required_modules.h"
#include "app/run/hit_recorder.h"
#include "app/run/render_job.h"
#include "app/sampled/sampled_run.h"
#include "app/site/result_page.h"
#include "app/sweep/plan/content.h"
#include "app/trace/heat_map.h"
#include "app/trace/memory_csv.h"
#include "app/trace/trace_file.h"
#include "core/config/own_sections.h"
#include "core/config/write.h"
#include "core/numeric/bytes_digest.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/read/document.h"
#include "report/run/memory_table.h"
#include "report/run/report_json.h"
#include "report/run/report_table.h"
#include "report/run/traffic_table.h"
#include "report/text/singular.h"

namespace carousel::app {

namespace {

void print_report(const RunArguments& arguments, const report::Report& report, const std::string& table,
                  const std::string& files) {
  if (arguments.json)
    print_result(report::json_text(report::sealed(report::report_json(report))) + "\n");
  else if (!arguments.quiet)
    print_text(report::singular(table) + "files        " + files + "\n");
}

/// Makes the files of a run appear, and prints its result: also where files cannot be written, which is an error after
/// that. Returns the exit status.
template <class WriteFiles>
int finish(const RunArguments& arguments, const report::Report& report, const std::string& table, RunOutputs& outputs,
           const InterruptScope& interrupt, const WriteFiles& write_files) {
  const std::exception_ptr failure = outputs.folder().write([&](const std::filesystem::path& folder) {
    const Phase phase("files");
    write_files(folder);
    outputs.publish_extras();
  });
  outputs.publish_extras();  // also where the folder cannot be written: each is whole by itself
  print_report(arguments, report, table, failure ? "none, they cannot be written" : outputs.folder().folder().string());
  const int status = outputs.tell_errors(verdict(report, interrupt.status()));
  if (failure) std::rethrow_exception(failure);
  return status;
}

/// The report is written last, so that the files it names exist before it does; the page shows the picture beside it.
void write_report(const std::filesystem::path& folder, const RunArguments& arguments, const report::Report& report) {
  const nlohmann::ordered_json json = report::report_json(report);
  if (!arguments.no_html) write_file(folder / "report.html", run_page_of(json, folder));
  write_file(folder / "report.json", report::json_text(report::sealed(json)) + "\n");
}

/// Refuses to write down the rays of a run: `instead` says why, and what is expected.
void require_no_hits(const RunArguments& arguments, const std::string& instead) {
  const auto refuse = [&](bool wanted, const char* option) {
    if (wanted) throw ConfigError({{{}, option, instead + ", or a run without this option"}});
  };
  refuse(arguments.hits, "--hits");
  refuse(!arguments.dump_rays.empty(), "--dump-rays");
  refuse(!arguments.dump_trees.empty(), "--dump-trees");
  refuse(!arguments.dump_memory.empty(), "--dump-memory");
  refuse(!arguments.heat.empty(), "--heat");
  refuse(!arguments.trace.file.empty(), "--trace");
}

/// Runs a workload without rays: the network or the memory alone.
int run_without_rays_command(const RunArguments& arguments, const Prepared& p, const InterruptScope& interrupt,
                             RunOutputs& outputs) {
  const bool traffic = p.config().workload.kind == WorkloadConfig::Kind::kTraffic;
  require_no_hits(arguments, fmt::format("{} no rays; expected workload: rays",
                                         traffic ? "synthetic traffic has" : "memory requests have"));
  const report::Report report = run_without_rays(p, interrupt, arguments.quiet);
  return finish(arguments, report, traffic ? report::traffic_table(report) : report::memory_table(report), outputs,
                interrupt, [&](const std::filesystem::path& folder) {
                  write_file(folder / "config.resolved.yaml", resolved_yaml(p.absolute_config()));
                  write_report(folder, arguments, report);
                });
}

/// Runs a series of frames, whose pictures are written as they are made.
int run_series_command(const RunArguments& arguments, Prepared& p, const InterruptScope& interrupt,
                       RunOutputs& outputs) {
  require_no_hits(
      arguments,
      fmt::format("a series shows {} frames, and this is of one; expected frames.count: 1, with frames.first",
                  p.config().frames->count));
  const std::filesystem::path& staging = outputs.folder().staging();
  const report::Report report =
      run_series(arguments, p, interrupt, arguments.quiet, [&](const RenderJob& job, std::int64_t frame, bool last) {
        job.write_images(staging, frame);
        if (last) job.write_images(staging);
      });
  return finish(arguments, report, report::report_table(report), outputs, interrupt,
                [&](const std::filesystem::path& folder) {
                  write_file(folder / "config.resolved.yaml", resolved_yaml(p.absolute_config()));
                  write_report(folder, arguments, report);
                });
}

/// Refuses what would need the rays of all ranks in one place.
void require_one_rank(const RunArguments& arguments) {
  const auto refuse = [&](bool wanted, const char* option) {
    if (wanted)
      throw ConfigError(
          {{{}, option, "not built yet over ranks; expected engine.transport: local, or a run without this option"}});
  };
  refuse(arguments.hits, "--hits");
  refuse(!arguments.dump_rays.empty(), "--dump-rays");
  refuse(!arguments.dump_trees.empty(), "--dump-trees");
}

/// Tells what two ranks note for a timeline apart.
std::string trace_text(const TraceArguments& trace) {
  if (trace.file.empty()) return "none";
  return fmt::format("window '{}', every {}, at most {} events", trace.window, trace.every, trace.events);
}

/// Why the cost of the pixels of such a run is not known, in words that follow "this run"; empty if it is.
std::string no_heat_because(const Prepared& p) {
  const Config& config = p.config();
  if (config.engine.kind != EngineKind::kCycle) return "is of the native engine; expected engine.kind: cycle";
  if (config.workload.kind != WorkloadConfig::Kind::kRays) return "makes no picture; expected workload: rays";
  if (config.bundles.size > 0) return "has bundles, whose rays have no packets of their own; expected bundles.size: 0";
  if (most_of_resources(config, [](const OwnSections& one) { return one.testers.simt.warp; }) > 0)
    return "has warps, which note no stages of a ray; expected testers.simt.warp: 0";
  if (config.faults.resource.kind == FaultsConfig::Resource::Kind::kStop)
    return "begins rays anew when a resource stops; expected another faults.resource.kind";
  if (config.rays.placement == Placement::kFirstTaker || config.rays.placement == Placement::kAddressed)
    return fmt::format("has rays.placement: {}, by which resources give slots away; expected balanced or round_robin",
                       enum_name(config.rays.placement));
  return "";
}

/// The maps show what only some runs know.
void require_heat(const RunArguments& arguments, const Prepared& p) {
  if (arguments.heat.empty()) return;
  if (const std::string why = no_heat_because(p); !why.empty())
    throw ConfigError("--heat", "this run " + why + ", or a run without this option");
}

/// Only a simulated machine has a memory.
void require_memory(const RunArguments& arguments, const Config& config) {
  if (!arguments.dump_memory.empty() && config.engine.kind != EngineKind::kCycle)
    throw ConfigError("--dump-memory",
                      "the native engine has no simulated memory; expected engine.kind: cycle, or a run without this "
                      "option");
}

/// Only estimates can be compared with the whole frame.
void require_estimates(const RunArguments& arguments, const Config& config) {
  if (arguments.audit && config.sampling.fraction >= 1)
    throw ConfigError("--audit",
                      "this run has no estimates; expected sampling.fraction below 1, as in --set "
                      "sampling.fraction=0.1, or a run without this option");
}

/// Tells two scenes apart, and the structures built of them, as far as all ranks have these.
std::string scene_digest(const Prepared& p) {
  const scene::Scene& s = p.scene;
  const accel::Partition* const parts = p.accel.partition.get();
  const auto digest = [](const auto& array, std::size_t first) {
    return bytes_digest(
        {reinterpret_cast<const char*>(array.data() + first), (array.size() - first) * sizeof array[0]});
  };
  return fmt::format("{} triangles, {} instances, {} materials, structure {}, primitives {}", s.unique_triangle_count(),
                     s.instances.size(), s.materials.size(),
                     digest(p.accel.nodes, parts != nullptr ? parts->node_begin.back() : 0),
                     digest(p.accel.blocks, parts != nullptr ? parts->block_begin.back() : 0));
}

void write_files(const std::filesystem::path& folder, const RunArguments& arguments, const Prepared& p,
                 const std::string& resolved, const RenderJob& job, const report::Report& report, HitRecorder* recorder,
                 ExtraFile* rays, std::span<const ringbus::PixelCost> heat) {
  write_file(folder / "config.resolved.yaml", resolved);
  job.write_images(folder);
  if (!arguments.heat.empty() && report.heat)
    write_heat(folder, heat, static_cast<std::uint32_t>(p.config().image.width), arguments.heat == "log");
  if (recorder) {
    const std::vector<report::HitRow> rows = recorder->take();
    if (rays) rays->write([&](AtomicFile& file) { report::write_rays_csv(file, rows, !report.incomplete); });
    if (arguments.hits) {
      AtomicFile file(folder / "hits.csv");
      report::write_hits_csv(file, rows, !report.incomplete);
      file.commit();
    }
  }
  write_report(folder, arguments, report);
}

}  // namespace

int run_command(const RunArguments& arguments) {
  const InterruptScope interrupt;
  const bool keep_hits = arguments.hits || !arguments.dump_rays.empty();
  std::optional<RunOutputs> outputs;
  std::optional<RankScope> ranks;
  Prepared p = prepare(
      arguments, {.force = arguments.force, .ranks = true, .frames = true, .searches = true}, keep_hits,
      [&](const Prepared& of) {
        require_modules(of.config().engine, of.config().workload, of.config().image);
        if (const Config& config = of.config(); config.engine.transport != EngineTransport::kLocal) {
          require_one_rank(arguments);
          ranks.emplace(config, program_identity());
          ranks->require_same("--trace", trace_text(arguments.trace));
          ranks->require_files([&] {
            return ContentDigests(of.config_folder).of(config.engine, config.scene, config.bvh, config.workload);
          });
          if (ranks->rank() != 0) return;  // one writes the files
        }
        outputs.emplace(arguments, of.absolute_config());
      },
      [&] { return ranks ? &ranks->transport() : nullptr; });
  if (!p.config().vary.empty())
    spdlog::warn("run ignores vary, which is for sweeps, and uses the values of the other keys");
  if (const std::vector<IgnoredKey> ignored = p.ignored(); !ignored.empty() && (!ranks || ranks->rank() == 0))
    spdlog::warn("this machine ignores {}", ignored_text(ignored));
  if (!p.has_rays()) return run_without_rays_command(arguments, p, interrupt, *outputs);
  require_memory(arguments, p.config());
  require_estimates(arguments, p.config());
  if (p.config().frames && p.config().frames->count > 1) return run_series_command(arguments, p, interrupt, *outputs);
  if (outputs)
    if (ExtraFile* const file = outputs->trees())
      file->write([&](AtomicFile& to) { accel::write_trees(to, p.accel, p.scene); });
  require_heat(arguments, p);

  const std::string resolved = resolved_yaml(p.absolute_config());  // of a search the configuration that it began with
  std::optional<report::AreaSearch> search;
  if (is_searched(p.config().area)) search = search_area(p, LocatedConfig(p.located), interrupt, arguments.quiet);

  RenderJob job(p);
  if (ranks) {
    ranks->require_same("scene", scene_digest(p));
    job.share(ranks->transport());
  }
  std::optional<HitRecorder> recorder;
  if (keep_hits) job.set_recorder(&recorder.emplace(static_cast<std::size_t>(shader_workers(p.config()))));
  std::optional<TraceFile> trace;
  if (!arguments.trace.file.empty())
    trace.emplace(arguments.trace, p.config().engine.kind == EngineKind::kNative, outputs ? outputs->trace() : nullptr);
  ringbus::MemoryLog memory;
  std::vector<ringbus::PixelCost> heat;
  if (!arguments.heat.empty()) heat.resize(static_cast<std::size_t>(p.config().image.width * p.config().image.height));
  const bool quiet = arguments.quiet || (ranks && ranks->rank() != 0);
  report::Report report = run_rays(arguments, p, job, interrupt, quiet, trace ? &*trace : nullptr,
                                   arguments.dump_memory.empty() ? nullptr : &memory, heat);
  if (ranks && ranks->rank() != 0) {
    ranks->leave();
    return report.incomplete ? interrupt.status() : kDone;
  }
  if (search && report.area) report.area->search = std::move(search);
  if (arguments.audit)
    audit(
        p, job, interrupt.token(), arguments.quiet,
        [&](const RenderJob& whole, const ringbus::RunResult& result) {
          return build_report(p, whole, result, nullptr).energy->nj_per_ray;
        },
        report);
  if (ExtraFile* const file = outputs->memory())
    file->write([&](AtomicFile& to) { write_memory_csv(to, memory, !report.incomplete); });
  const int status = finish(arguments, report, report::report_table(report), *outputs, interrupt,
                            [&](const std::filesystem::path& folder) {
                              write_files(folder, arguments, p, resolved, job, report, recorder ? &*recorder : nullptr,
                                          outputs->rays(), heat);
                            });
  if (ranks) ranks->leave();
  return status;
}

}  // namespace carousel::app
