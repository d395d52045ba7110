#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// sweep.html of `carousel sweep`, from its sweep.json. `folder` is the sweep's, as the command that makes a point's
/// own page has to name it.
std::string sweep_page(const nlohmann::ordered_json& sweep, const std::string& folder);

}  // namespace carousel::report::html
