#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// sweep.html of `carousel sweep`, from its sweep.json. `folder` is the sweep's, as the command that makes a point's
/// own page has to name it. A page that `asks` comes from a server that simulates further points (`carousel serve`).
std::string sweep_page(const nlohmann::ordered_json& sweep, const std::string& folder, bool asks = false);

}  // namespace carousel::report::html
