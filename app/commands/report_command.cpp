#include "app/commands/report_command.h"

#include <fstream>
#include <optional>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/html/run_page.h"
#include "shading/camera/page_picture.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

std::string run_page_of(const Json& report, const std::filesystem::path& folder) {
  report::html::Picture picture;
  if (report.contains("digest") && report["digest"].contains("image"))
    if (const auto found = shading::page_picture(folder / "image.png")) picture = {found->mime_type, found->bytes};
  return report::html::run_page(report, picture);
}

int report_command(const ReportArguments& arguments) {
  std::filesystem::path file = arguments.folder;
  if (std::filesystem::is_directory(file)) file /= "report.json";
  std::ifstream in(file);
  if (!in) throw FileError(file.string() + ": cannot be read");
  const Json report = Json::parse(in, nullptr, false);
  if (report.is_discarded() || !report.is_object() || !report.contains("config") || !report.contains("engine"))
    throw FileError(file.string() + ": expected the report.json of carousel run");
  const std::filesystem::path page =
      arguments.out.empty() ? file.parent_path() / "report.html" : std::filesystem::path(arguments.out);
  write_file(page, run_page_of(report, file.parent_path()));
  print_result("page         " + page.string() + "\n");
  return kDone;
}

}  // namespace carousel::app
