#include "app/sweep/process/point_run.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/area/machine_area.h"
#include "app/area_search/area_search.h"
#include "app/build_report/experiment.h"
#include "app/build_report/verdict.h"
#include "app/host/interrupt.h"
#include "core/system/error.h"
#include "report/run/report_json.h"
#include "report/text/singular.h"

namespace carousel::app {

PointError current_error() {
  try {
    throw;
  } catch (const ConfigError& error) {
    constexpr std::size_t kShown = 10;
    std::string text;
    for (std::size_t i = 0; i < std::min(error.issues().size(), kShown); ++i)
      text += (text.empty() ? "" : "\n") + error.issues()[i].text();
    if (error.issues().size() > kShown)
      text += report::singular(fmt::format("\n{} more errors", error.issues().size() - kShown));
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
    LocatedConfig machine = load_config(setup.source, point.sets);
    prepared.threads = prepared.threads_beside = point_threads(machine.config);
    std::optional<report::AreaSearch> search;
    if (is_searched(machine.config.area))
      search = search_area(prepared, machine, interrupt, true);
    else
      set_machine(prepared, std::move(machine));
    report::Report report;
    if (prepared.has_rays()) {
      RenderJob job(prepared);
      report = run_rays({setup.config.string(), point.sets}, prepared, job, interrupt, true);
    } else {
      report = run_without_rays(prepared, interrupt, true);
    }
    if (search) report.area->search = std::move(search);
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
