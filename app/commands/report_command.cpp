#include "app/commands/report_command.h"

#include <fstream>
#include <optional>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/sweep/process/point_file.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/html/run_page.h"
#include "report/html/study_pages.h"
#include "report/html/sweep_page.h"
#include "shading/camera/page_picture.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

std::string run_page_of(const Json& report, const std::filesystem::path& folder) {
  report::html::Picture picture;
  if (report.contains("digest") && report["digest"].contains("image"))
    if (const auto found = shading::page_picture(folder / "image.png")) picture = {found->mime_type, found->bytes};
  return report::html::run_page(report, picture);
}

namespace {

constexpr const char* kExpected =
    "expected the report.json of carousel run, a sweep.json or a point of it, a stress.json, an accuracy.json, or the "
    "JSON of carousel follow";

/// The page of any file that a command wrote, told by its keys.
std::string page_of_file(const Json& json, const std::filesystem::path& file) {
  if (json.contains("ray_life")) return report::html::ray_life_page(json["ray_life"]);
  if (json.contains("spans") && json.contains("stages")) return report::html::ray_life_page(json);
  if (json.contains("point") && json.contains("keys")) {
    if (!json.contains("report")) throw FileError(file.string() + ": the point has no report, since its run failed");
    return run_page_of(json["report"], file.parent_path());
  }
  if (json.contains("points") && json.contains("main_effects"))
    return report::html::sweep_page(json, file.has_parent_path() ? file.parent_path().string() : ".");
  if (json.contains("config") && json.contains("engine")) return run_page_of(json, file.parent_path());
  if (json.contains("levels") && json.contains("spawn")) return report::html::accuracy_page(json);
  if (json.contains("rows") && json.contains("cores")) return report::html::stress_page(json);
  throw FileError(file.string() + ": " + kExpected);
}

}  // namespace

int report_command(const ReportArguments& arguments) {
  std::filesystem::path file = arguments.folder;
  if (!arguments.point.empty())
    file = point_path(file, arguments.point);
  else if (std::filesystem::is_directory(file))
    file /= std::filesystem::exists(file / "sweep.json") ? "sweep.json" : "report.json";
  std::ifstream in(file);
  if (!in) throw FileError(file.string() + ": cannot be read");
  const Json report = Json::parse(in, nullptr, false);
  if (report.is_discarded() || !report.is_object()) throw FileError(file.string() + ": " + kExpected);
  const std::filesystem::path page = arguments.out.empty() ? std::filesystem::path(file).replace_extension(".html")
                                                           : std::filesystem::path(arguments.out);
  write_file(page, page_of_file(report, file));
  print_result("page         " + page.string() + "\n");
  return kDone;
}

}  // namespace carousel::app
