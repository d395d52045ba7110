#include "app/versus/versus_command.h"

#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/area/machine_area.h"
#include "app/area_search/area_search.h"
#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/host/output_folder.h"
#include "app/versus/twin.h"
#include "app/versus/versus_runs.h"
#include "core/config/write.h"
#include "core/system/atomic_file.h"
#include "report/html/studies/study_pages.h"
#include "report/read/document.h"
#include "report/run/report_json.h"

namespace carousel::app {

int versus_command(const VersusArguments& arguments) {
  const InterruptScope interrupt;
  std::filesystem::path folder = arguments.out;
  if (folder.empty())
    folder = std::filesystem::path("out") / (std::filesystem::path(arguments.config).stem().string() + "-versus");
  std::optional<OutputFolder> output;
  std::string resolved;
  Prepared p = prepare(arguments, {.searches = true}, false, [&](const Prepared& of) {
    static_cast<void>(conventional_twin(of.located));  // refuses before the scene is loaded
    const Config config = of.absolute_config();
    resolved = resolved_yaml(config);
    output.emplace(folder, &config, arguments.force, Results::kVersus);
  });
  std::optional<AreaConfig::Aim> best;
  if (is_searched(p.config().area)) best = p.config().area.aim;
  std::optional<report::AreaSearch> search;
  if (best) search = search_area(p, LocatedConfig(p.located), interrupt, arguments.quiet);
  report::Versus versus = run_versus(p, {arguments.seeds, !arguments.no_search, arguments.quiet, best}, interrupt);
  versus.search = std::move(search);
  const nlohmann::ordered_json result = report::versus_json(versus);
  const std::string json = report::json_text(report::sealed(result)) + "\n";
  const std::exception_ptr failure = output->write([&](const std::filesystem::path& staging) {
    write_file(staging / "config.resolved.yaml", resolved);
    write_file(staging / "versus.html", report::html::versus_page(result));
    write_file(staging / "versus.json", json);
  });
  if (arguments.json) {
    print_result(json);
  } else if (!arguments.quiet) {
    std::string text;
    for (const std::string& line : versus.lines) text += line + "\n";
    if (versus.drawing) text += *versus.drawing + "\n";
    print_text(text + (failure ? "files: none, they cannot be written\n"
                               : "files: " + (folder / "versus.json").string() + ", versus.html\n"));
  }
  if (failure) std::rethrow_exception(failure);
  return kDone;
}

}  // namespace carousel::app
