#include "app/commands/report_command.h"

#include <optional>
#include <vector>

#include <fmt/format.h>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/site/result_page.h"
#include "app/sweep/process/point_file.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/read/document.h"

namespace carousel::app {

namespace {

/// The results in a folder. Throws a FileError if there is nothing.
std::vector<std::filesystem::path> some_results_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out = results_in(folder);
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
    files = some_results_in(named);
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
