#include "app/commands/report_command.h"

#include <optional>
#include <vector>

#include <fmt/format.h>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/sweep/process/point_file.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/html/run_page.h"
#include "report/html/study_pages.h"
#include "report/html/sweep_page.h"
#include "report/read/document.h"
#include "shading/camera/page_picture.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

std::string run_page_of(const Json& report, const std::filesystem::path& folder) {
  report::html::Picture picture, heat;
  if (report.contains("digest") && report["digest"].contains("image"))
    if (const auto found = shading::page_picture(folder / "image.png")) picture = {found->mime_type, found->bytes};
  if (report.contains("heat"))
    if (const auto found = shading::page_picture(folder / "heat_cycles.png")) heat = {found->mime_type, found->bytes};
  return report::html::run_page(report, picture, heat);
}

namespace {

/// The page of any file that a command wrote.
std::string page_of_file(const report::Document& document, const std::filesystem::path& file) {
  using report::DocumentKind;
  const Json& json = document.json;
  switch (document.kind) {
    case DocumentKind::kRayLife:
      return report::html::ray_life_page(json);
    case DocumentKind::kPoint:
      if (!json.contains("report")) throw FileError(file.string() + ": the point has no report, since its run failed");
      return run_page_of(json["report"], file.parent_path());
    case DocumentKind::kSweep:
      return report::html::sweep_page(json, file.has_parent_path() ? file.parent_path().string() : ".");
    case DocumentKind::kAccuracy:
      return report::html::accuracy_page(json);
    case DocumentKind::kStress:
      return report::html::stress_page(json);
    case DocumentKind::kVersus:
      return report::html::versus_page(json);
    default:
      return run_page_of(json, file.parent_path());
  }
}

/// The results that commands wrote to a folder, side by side. Throws a FileError if there is nothing.
std::vector<std::filesystem::path> results_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  for (const char* name : {"sweep.json", "report.json", "accuracy.json", "stress.json", "versus.json"})
    if (std::filesystem::exists(folder / name)) out.push_back(folder / name);
  if (out.empty())
    throw FileError(folder.string() +
                    ": no result of a command is in this folder: sweep.json, report.json, accuracy.json, "
                    "stress.json or versus.json");
  return out;
}

}  // namespace

int report_command(const ReportArguments& arguments) {
  const std::filesystem::path named = arguments.folder;
  std::vector<std::filesystem::path> files{named};
  if (!arguments.point.empty())
    files = {point_path(named, arguments.point)};
  else if (std::filesystem::is_directory(named))
    files = results_in(named);
  if (files.size() > 1 && !arguments.out.empty())
    throw FileError(fmt::format("{}: {} results are in this folder, and --out is one page: name one of them",
                                named.string(), files.size()));
  for (const std::filesystem::path& file : files) {
    const report::Document document = report::read_document(file);
    const std::filesystem::path page = arguments.out.empty() ? std::filesystem::path(file).replace_extension(".html")
                                                             : std::filesystem::path(arguments.out);
    write_file(page, page_of_file(document, file));
    print_result("page         " + page.string() + "\n");
  }
  return kDone;
}

}  // namespace carousel::app
