#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "report/accuracy/accuracy.h"

namespace carousel::report {

/// For a terminal, all of it: levels against time and errors, hard cases, spawn offsets, samples, and the verdict.
std::string accuracy_table(const Accuracy& accuracy);

/// accuracy.json: all of it, with units in the names.
nlohmann::ordered_json accuracy_json(const Accuracy& accuracy);

}  // namespace carousel::report
