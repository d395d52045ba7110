#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// stress.html of `carousel stress`, from its stress.json.
std::string stress_page(const nlohmann::ordered_json& stress);

/// accuracy.html of `carousel accuracy`, from its accuracy.json.
std::string accuracy_page(const nlohmann::ordered_json& accuracy);

/// versus.html of `carousel versus`, from its versus.json.
std::string versus_page(const nlohmann::ordered_json& versus);

/// The page of one ray's life, from what `carousel follow --json` prints.
std::string ray_life_page(const nlohmann::ordered_json& life);

}  // namespace carousel::report::html
