#include "app/sweep/process/point_run.h"

#include <chrono>
#include <new>
#include <optional>

#include <fmt/format.h>

#include "accel/planes/cull_planes.h"
#include "accel/traverse/verifying_workload.h"
#include "app/build_report/build_report.h"
#include "app/build_report/memory_report.h"
#include "app/build_report/traffic_report.h"
#include "app/build_report/verdict.h"
#include "app/host/interrupt.h"
#include "app/host/machine_info.h"
#include "app/run/bottleneck.h"
#include "app/run/effects_proof.h"
#include "app/run/fault_cost.h"
#include "app/run/memory_csv.h"
#include "app/run/memory_need.h"
#include "app/run/render_job.h"
#include "core/system/error.h"
#include "report/run/report_json.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/memory/memory_trace.h"
#include "ringbus/cycle/memory/shape_room.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/protocol/deadlock.h"

namespace carousel::app {

namespace {

/// The checks that need both the machine and the structure, as prepare() makes them.
void require_room(const Prepared& p) {
  if (std::vector<ConfigIssue> issues = ringbus::check_storage(p.config(), p.accel); !issues.empty())
    throw ConfigError(std::move(issues));
  if (std::vector<ConfigIssue> issues = ringbus::cycle::check_shape_buffer(p.config(), p.accel); !issues.empty())
    throw ConfigError(std::move(issues));
  require_fit(estimate(p.config(), false, p.scene, p.accel), usable_memory_bytes(), p.located.positions);
}

report::Report simulate_traffic(const Prepared& p, const InterruptScope& interrupt) {
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  return traffic_report(p, ringbus::run_traffic(p.config(), options));
}

report::Report simulate_memory(const Prepared& p, const InterruptScope& interrupt) {
  const ringbus::MemoryLog requests = read_memory_csv(find_beside(p.config_folder, p.config().workload.memory_trace));
  return memory_report(p, ringbus::run_memory_trace(p.config(), requests, interrupt.token()));
}

report::Report simulate(const Prepared& p, const ConfigArguments& arguments, const InterruptScope& interrupt) {
  RenderJob job(p);
  std::optional<accel::VerifyingWorkload> verifying;
  std::optional<accel::Accel> plain;
  if (p.config().verify == Verify::kReference) {
    if (!accel::is_plain(p.accel)) plain = accel::plain_copy(p.accel);
    verifying.emplace(job.workload(), plain ? *plain : p.accel);
  }
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = interrupt.token();
  options.samples = static_cast<std::size_t>(p.config().report.samples);
  const auto run = p.config().engine.kind == EngineKind::kCycle ? ringbus::run_cycle : ringbus::run_native;
  const ringbus::RunResult result =
      run(p.config(), p.accel, p.scene_size(), verifying ? *verifying : job.workload(), options);
  report::Report report = build_report(p, job, result, verifying ? &*verifying : nullptr);
  if (result.cycle) {
    report.bound = bound_of(result);
    if (p.config().engine.what_if) report.bottleneck = find_bottleneck(p, job, result, interrupt.token(), true);
  }
  if (p.config().faults.compare) compare_without_faults(p, interrupt.token(), true, report);
  if (p.config().verify == Verify::kEffects) prove_effects(arguments, p, interrupt, true, report);
  return report;
}

}  // namespace

PointError current_error() {
  try {
    throw;
  } catch (const ConfigError& error) {
    std::string text;
    for (const ConfigIssue& issue : error.issues()) text += (text.empty() ? "" : "\n") + issue.text();
    return {"config", text};
  } catch (const SceneError& error) {
    return {"scene", error.what()};
  } catch (const FileError& error) {
    return {"file", error.what()};
  } catch (const std::bad_alloc&) {
    return {"memory", "not enough memory"};
  } catch (const std::exception& error) {
    return {"simulation", error.what()};
  }
}

std::optional<PointError> run_point(const SweepSetup& setup, Prepared& prepared, const SweepPoint& point) {
  try {
    const auto start = std::chrono::steady_clock::now();
    const InterruptScope interrupt;
    prepared.located = load_config(setup.source, point.sets);
    prepared.threads = point_threads(prepared.config());
    const bool traffic = prepared.config().workload.kind == WorkloadConfig::Kind::kTraffic;
    const bool requests = prepared.config().workload.kind == WorkloadConfig::Kind::kMemoryTrace;
    if (!traffic && !requests) require_room(prepared);
    const report::Report report = traffic    ? simulate_traffic(prepared, interrupt)
                                  : requests ? simulate_memory(prepared, interrupt)
                                             : simulate(prepared, {setup.config.string(), point.sets}, interrupt);
    std::optional<PointError> error;
    if (verdict(report, kInterrupted) != kDone) error = {"verification", "a verification or comparison failed"};
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    write_point(setup.out, point, seconds.count(), error, report::report_json(report));
    return error;
  } catch (...) {
    return current_error();
  }
}

}  // namespace carousel::app
