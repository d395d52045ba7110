#include "report/read/schema_check.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/text/edit_distance.h"
#include "report/read/strict_json.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

bool has_type(const Json& value, std::string_view type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

std::string type_words(std::string_view type) {
  if (type == "object") return "an object";
  if (type == "array") return "a list";
  if (type == "string") return "a text";
  if (type == "boolean") return "true or false";
  if (type == "integer") return "a whole number";
  return type == "number" ? "a number" : std::string(type);
}

std::vector<std::string> types_of(const Json& schema) {
  const auto type = schema.find("type");
  if (type == schema.end()) return {};
  return type->is_array() ? type->get<std::vector<std::string>>() : std::vector<std::string>{type->get<std::string>()};
}

std::string types_words(const Json& schema) {
  std::string out;
  for (const std::string& type : types_of(schema)) out += (out.empty() ? "" : " or ") + type_words(type);
  return out;
}

[[noreturn]] void fail(const std::string& path, const std::string& expected, const std::string& found) {
  throw JsonFault(path, "expected " + expected + ", found " + found);
}

class Check {
 public:
  void value(const Json& schema, const Json& value, const std::string& path) const {
    const std::vector<std::string> types = types_of(schema);
    if (!types.empty() && std::none_of(types.begin(), types.end(), [&](const auto& t) { return has_type(value, t); }))
      fail(path, types_words(schema), found_text(value));
    if (const auto fixed = schema.find("const"); fixed != schema.end() && value != *fixed)
      fail(path, found_text(*fixed), found_text(value));
    if (const auto one = schema.find("enum");
        one != schema.end() && std::find(one->begin(), one->end(), value) == one->end())
      fail(path, "one of " + one->dump(), found_text(value));
    if (value.is_number()) number(schema, value, path);
    if (value.is_array()) array(schema, value, path);
    if (value.is_object()) object(schema, value, path);
  }

 private:
  static void number(const Json& schema, const Json& value, const std::string& path) {
    if (const auto least = schema.find("minimum"); least != schema.end() && value < *least)
      fail(path, "at least " + least->dump(), value.dump());
    if (const auto most = schema.find("maximum"); most != schema.end() && value > *most)
      fail(path, "at most " + most->dump(), value.dump());
  }

  void array(const Json& schema, const Json& list, const std::string& path) const {
    if (const auto least = schema.find("minItems"); least != schema.end() && list.size() < least->get<std::size_t>())
      fail(path, fmt::format("at least {} values", least->dump()), std::to_string(list.size()));
    if (const auto most = schema.find("maxItems"); most != schema.end() && list.size() > most->get<std::size_t>())
      fail(path, fmt::format("at most {} values", most->dump()), std::to_string(list.size()));
    const auto items = schema.find("items");
    if (items == schema.end()) return;
    // Long lists hold plain numbers, whose paths are only made for an error.
    if (*items == Json{{"type", "number"}} &&
        std::all_of(list.begin(), list.end(), [](const Json& item) { return item.is_number(); }))
      return;
    for (std::size_t i = 0; i < list.size(); ++i) value(*items, list[i], path_below(path, i));
  }

  void object(const Json& schema, const Json& map, const std::string& path) const {
    const auto properties = schema.find("properties");
    if (const auto required = schema.find("required"); required != schema.end())
      for (const Json& key : *required) {
        const std::string name = key.get<std::string>();
        if (!map.contains(name)) fail(path_below(path, name), types_words((*properties)[name]), "nothing");
      }
    const auto others = schema.find("additionalProperties");
    for (const auto& [key, item] : map.items()) {
      const std::string below = path_below(path, key);
      if (properties != schema.end() && properties->contains(key))
        value((*properties)[key], item, below);
      else if (others != schema.end() && others->is_object())
        value(*others, item, below);
      else if (others != schema.end() && *others == false)
        unknown(*properties, key, below);
    }
  }

  [[noreturn]] static void unknown(const Json& properties, const std::string& key, const std::string& path) {
    std::vector<std::string> known;
    for (const auto& [name, about] : properties.items()) known.push_back(name);
    const auto near = nearest_name(key, known);
    throw JsonFault(path, "no such key" + (near ? "; did you mean " + *near + "?" : ""));
  }
};

}  // namespace

void require_schema(const Json& schema, const Json& value) {
  Check().value(schema, value, "");
}

bool is_checked_in_full(const Json& schema) {
  constexpr std::array<std::string_view, 17> kKnown{
      "type",     "enum",     "const",       "minimum",    "maximum", "items",
      "minItems", "maxItems", "required",    "properties", "$defs",   "additionalProperties",
      "$schema",  "title",    "description", "unit",       "default"};
  for (const auto& [key, value] : schema.items()) {
    if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) return false;
    if (key == "properties" || key == "$defs") {
      if (!std::all_of(value.begin(), value.end(), is_checked_in_full)) return false;
    } else if ((key == "items" || key == "additionalProperties") && value.is_object() && !is_checked_in_full(value)) {
      return false;
    }
  }
  return true;
}

}  // namespace carousel::report
