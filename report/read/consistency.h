#pragma once

#include <nlohmann/json.hpp>

namespace carousel::report {

// What a schema cannot say: lists of equal length, and numbers that are places in other lists. Each function takes a
// document that keeps its schema, and throws a JsonFault for the first place where it contradicts itself.

void require_consistent_run(const nlohmann::ordered_json& report);
void require_consistent_sweep(const nlohmann::ordered_json& sweep);

}  // namespace carousel::report
