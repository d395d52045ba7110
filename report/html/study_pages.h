#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// stress.html of `carousel stress`, from its stress.json.
std::string stress_page(const nlohmann::ordered_json& stress);

/// accuracy.html of `carousel accuracy`, from its accuracy.json.
std::string accuracy_page(const nlohmann::ordered_json& accuracy);

}  // namespace carousel::report::html
