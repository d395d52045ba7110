#pragma once

#include <nlohmann/json.hpp>

namespace carousel::report {

/// Throws a JsonFault for the first place where the value breaks the schema. It knows the keywords of JSON Schema that
/// the schemas of report/ use: type, enum, const, minimum, maximum, items, minItems, maxItems, properties, required and
/// additionalProperties. A number is an integer only if it is written as one.
void require_schema(const nlohmann::ordered_json& schema, const nlohmann::ordered_json& value);

/// False if the schema uses a keyword that require_schema would not check.
bool is_checked_in_full(const nlohmann::ordered_json& schema);

}  // namespace carousel::report
