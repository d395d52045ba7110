#include "app/commands/compare_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "core/system/error.h"
#include "report/run/report_difference.h"
#include "ringbus/cycle/cycle_engine.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostDifferences = 20;

Json read_report(const std::string& name) {
  std::filesystem::path path = name;
  if (std::filesystem::is_directory(path)) path /= "report.json";
  std::ifstream in(path);
  if (!in) throw FileError(path.string() + ": cannot be read");
  Json json = Json::parse(in, nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("config") || !json.contains("digest"))
    throw FileError(path.string() + ": expected a report of carousel run");
  return json;
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
  const Json a = read_report(arguments.a), b = read_report(arguments.b);
  const std::vector<report::Difference> found = report::differences(a, b);
  if (found.empty()) {
    print_result("identical\n");
    return kDone;
  }
  std::string text = fmt::format("{} values differ\n", found.size());
  std::size_t width = 0;
  const std::size_t shown = std::min(found.size(), kMostDifferences);
  for (std::size_t i = 0; i < shown; ++i) width = std::max(width, found[i].path.size());
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("  {:<{}}  {}  {}\n", found[i].path, width, found[i].a.empty() ? "-" : found[i].a,
                        found[i].b.empty() ? "-" : found[i].b);
  if (shown < found.size()) text += fmt::format("  and {} more\n", found.size() - shown);
  print_result(text + first_divergence(a, b));
  return arguments.expect_identical ? kBroken : kDone;
}

}  // namespace carousel::app
