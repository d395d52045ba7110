#pragma once

#include <nlohmann/json.hpp>

namespace carousel::report {

// These checks find faults that a schema cannot express: lists of unequal length, and numbers that are no places in
// other lists. Each function takes a document that keeps its schema, and throws a JsonFault for the first place where
// it contradicts itself.

void require_consistent_run(const nlohmann::ordered_json& report);
void require_consistent_sweep(const nlohmann::ordered_json& sweep);

}  // namespace carousel::report
