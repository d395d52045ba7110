#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "report/html/page.h"

namespace carousel::report::html {

/// report.html of a run, from its report.json. Also for reports of older programs: sections whose numbers are missing
/// are left out.
std::string run_page(const nlohmann::ordered_json& report, const Picture& picture, const Picture& heat = {});

}  // namespace carousel::report::html
