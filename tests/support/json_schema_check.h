#pragma once

#include <regex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace carousel {

inline bool has_schema_type(const nlohmann::ordered_json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

/// Where `value` breaks `schema`: the keywords of JSON Schema that our schemas use, and no others.
inline std::vector<std::string> schema_problems(const nlohmann::ordered_json& schema,
                                                const nlohmann::ordered_json& value, const std::string& path = "") {
  using Json = nlohmann::ordered_json;
  std::vector<std::string> problems;
  const auto fail = [&](const std::string& what) { problems.push_back(path + ": " + what + ": " + value.dump()); };
  const auto merge = [&](const std::vector<std::string>& more) {
    problems.insert(problems.end(), more.begin(), more.end());
  };
  if (schema.is_boolean()) {
    if (!schema.get<bool>()) fail("not allowed");
    return problems;
  }
  if (schema.contains("type")) {
    const Json types = schema["type"].is_array() ? schema["type"] : Json::array({schema["type"]});
    bool any = false;
    for (const Json& type : types) any = any || has_schema_type(value, type);
    if (!any) fail("expected " + schema["type"].dump());
  }
  if (schema.contains("const") && value != schema["const"]) fail("expected " + schema["const"].dump());
  if (schema.contains("enum")) {
    bool any = false;
    for (const Json& one : schema["enum"]) any = any || one == value;
    if (!any) fail("expected one of " + schema["enum"].dump());
  }
  if (value.is_number()) {
    const double number = value;
    if (schema.contains("minimum") && number < schema["minimum"].get<double>()) fail("below the minimum");
    if (schema.contains("maximum") && number > schema["maximum"].get<double>()) fail("above the maximum");
    if (schema.contains("exclusiveMinimum") && number <= schema["exclusiveMinimum"].get<double>()) fail("too small");
  }
  if (value.is_string() && schema.contains("minLength") &&
      value.get<std::string>().size() < schema["minLength"].get<std::size_t>())
    fail("too short");
  if (value.is_string() && schema.contains("pattern") &&
      !std::regex_search(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>())))
    fail("breaks the pattern");
  for (const char* combine : {"anyOf", "oneOf"}) {
    if (!schema.contains(combine)) continue;
    int matches = 0;
    for (const Json& one : schema[combine]) matches += schema_problems(one, value, path).empty();
    if (matches == 0 || (matches > 1 && std::string(combine) == "oneOf")) fail(std::string("breaks ") + combine);
  }
  if (value.is_array()) {
    if (schema.contains("minItems") && value.size() < schema["minItems"].get<std::size_t>()) fail("too few");
    if (schema.contains("maxItems") && value.size() > schema["maxItems"].get<std::size_t>()) fail("too many");
    if (schema.contains("items"))
      for (std::size_t i = 0; i < value.size(); ++i)
        merge(schema_problems(schema["items"], value[i], path + "/" + std::to_string(i)));
  }
  if (value.is_object()) {
    if (schema.contains("required"))
      for (const Json& key : schema["required"])
        if (!value.contains(key.get<std::string>())) fail("lacks " + key.dump());
    for (const auto& [key, item] : value.items()) {
      if (schema.contains("properties") && schema["properties"].contains(key))
        merge(schema_problems(schema["properties"][key], item, path + "/" + key));
      else if (schema.contains("additionalProperties"))
        merge(schema_problems(schema["additionalProperties"], item, path + "/" + key));
    }
  }
  return problems;
}

}  // namespace carousel
