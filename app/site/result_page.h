#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/read/document.h"

namespace carousel::app {

/// report.html of a run whose picture, if it has one, is `folder`/image.png, and its map of pixels heat.csv there.
/// Where `folder` or its neighbour `folder`-versus has a versus.json of the same machine, that is told beside the
/// answers.
std::string run_page_of(const nlohmann::ordered_json& report, const std::filesystem::path& folder);

/// The page of any file that a command wrote. Throws FileError for a point without a report.
/// `asks`: the server of the page simulates points.
std::string page_of_file(const report::Document& document, const std::filesystem::path& file, bool asks = false);

/// The results that commands wrote to a folder, side by side; none if there are none.
std::vector<std::filesystem::path> results_in(const std::filesystem::path& folder);

}  // namespace carousel::app
