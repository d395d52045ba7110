#include "app/commands/compare_command.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/compare/comparison.h"
#include "report/html/studies/compare_page.h"
#include "report/read/document.h"
#include "report/run/report_difference.h"
#include "ringbus/cycle/cycle_engine.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

Json read_report(const std::string& name) {
  std::filesystem::path path = name;
  if (std::filesystem::is_directory(path)) path /= "report.json";
  report::Document document = report::read_document(path);
  if (document.kind != report::DocumentKind::kRun)
    throw FileError(path.string() + ": expected a report of carousel run");
  return std::move(document.json);
}

/// The steps of a report's machine in a range of cycles.
std::vector<ringbus::cycle::Step> steps_of(const Json& report, const report::EpochRange& epoch) {
  const Prepared p = prepare_config(report["config"].dump(), "config of the report");
  RenderJob job(p);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.trace = {epoch.first_cycle, epoch.end_cycle};
  return ringbus::run_cycle(p.config(), p.accel, p.scene_size(), job.workload(), options).cycle->steps;
}

std::string first_divergence(const Json& a, const Json& b) {
  const report::EpochRange epoch = report::first_differing_epoch(a, b);
  if (!epoch.found) return "";
  std::string text = fmt::format("first differing epoch: cycles {} to {}\n", epoch.first_cycle, epoch.end_cycle - 1);
  const std::vector<ringbus::cycle::Step> left = steps_of(a, epoch), right = steps_of(b, epoch);
  const auto [l, r] = std::mismatch(left.begin(), left.end(), right.begin(), right.end());
  if (l == left.end() && r == right.end())
    return text + "a second run of both shows no difference there: one of the reports was written by another program\n";
  const auto told = [](const auto& at, const auto& end) {
    return at == end ? std::string("nothing more in this epoch") : ringbus::cycle::step_text(*at);
  };
  return text + fmt::format("first divergence\n  A: {}\n  B: {}\n", told(l, left.end()), told(r, right.end()));
}

}  // namespace

int compare_command(const CompareArguments& arguments) {
  std::vector<report::ComparedRun> runs;
  for (const std::string& name : arguments.runs) runs.push_back({name, read_report(name)});
  const report::Comparison comparison = report::compare_runs(runs, arguments.only);
  const bool all = arguments.all || !arguments.only.empty();
  if (!arguments.html.empty()) write_file(arguments.html, report::html::compare_page(comparison, all));
  if (arguments.json) {
    print_result(report::comparison_json(comparison, all).dump(2) + "\n");
  } else {
    std::string text = report::comparison_table(comparison, all);
    const bool unexpected = comparison.same_configuration && comparison.deterministic;
    if (!comparison.identical && runs.size() == 2 && (arguments.all || (unexpected && arguments.only.empty())))
      text += first_divergence(runs[0].report, runs[1].report);
    print_text(text);
  }
  return arguments.expect_identical && !comparison.identical ? kBroken : kDone;
}

}  // namespace carousel::app
