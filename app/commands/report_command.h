#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace carousel::app {

struct ReportArguments {
  std::string folder;  ///< of a run
  std::string out;     ///< page to write; empty: report.html in the folder
};

/// report.html of a run whose picture, if it has one, is `folder`/image.png.
std::string run_page_of(const nlohmann::ordered_json& report, const std::filesystem::path& folder);

/// `carousel report`: makes the page of a run again from its report.json and image.png. Returns the exit status.
int report_command(const ReportArguments& arguments);

}  // namespace carousel::app
