#include "core/config/config_page.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/schema.h"

namespace carousel {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kHead =
    "# The keys of a configuration\n\n"
    "This page is written by `carousel schema config --markdown`. A file is YAML or JSON; only `scene` has to be "
    "given.\n"
    "A value marked *native* or *cycle* is taken by that engine only; one that is *not built* is refused by both. "
    "Numbers of\nthe simulated machine (times, widths, sizes) mean nothing to the native engine, whose clock is the "
    "wall: it ignores them.\n";
constexpr std::string_view kTableHead = "\n| key | values | default | unit | meaning |\n|---|---|---|---|---|\n";

std::string engines_text(const Json& schema, const std::string& value) {
  if (!schema.contains("engines") || !schema["engines"].contains(value)) return "";
  const auto names = schema["engines"][value].get<std::vector<std::string>>();
  return names.empty() ? " *(not built)*" : fmt::format(" *({})*", fmt::join(names, ", "));
}

std::string values_text(const Json& schema) {
  if (schema.contains("const")) return fmt::format("`{}`", schema["const"].get<std::string>());
  if (schema.contains("enum")) {
    std::string out;
    for (const std::string value : schema["enum"])
      out += fmt::format("{}`{}`{}", out.empty() ? "" : ", ", value, engines_text(schema, value));
    return out;
  }
  if (schema.contains("anyOf")) {
    std::string out;
    for (const Json& alternative : schema["anyOf"]) out += (out.empty() ? "" : " or ") + values_text(alternative);
    return out;
  }
  if (!schema["type"].is_string()) return "value";
  const std::string type = schema["type"];
  if (type == "object") return "map";
  if (type == "array") return schema["items"].contains("enum") ? "list of " + values_text(schema["items"]) : "list";
  if (type == "string") return "text";
  if (type == "boolean") return fmt::format("`true`{}, `false`", engines_text(schema, "true"));
  const bool above = schema.contains("exclusiveMinimum");
  const std::string others = "others than the default", only = engines_text(schema, others);
  return fmt::format("{}{} to {}{}", above ? "above " : "", schema[above ? "exclusiveMinimum" : "minimum"].dump(),
                     schema["maximum"].dump(), only.empty() ? "" : "; " + others + only);
}

std::string row(const std::string& path, const Json& schema) {
  std::string shown;
  if (schema.contains("default"))
    shown = schema["default"].is_string() ? schema["default"].get<std::string>() : schema["default"].dump();
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", path, values_text(schema), shown, schema.value("unit", ""),
                     schema.value("description", ""));
}

}  // namespace

std::string config_markdown() {
  std::string out(kHead);
  config::walk_schema(config_schema(), [&](const std::string& path, const Json& schema) {
    if (path.find(".0.testers.") != path.npos) return;  // an override of the testers has the keys of `testers`
    const bool section = schema.contains("properties");
    if (path.find('.') == path.npos) {
      out += fmt::format("\n## {}\n", path);
      if (section) out += fmt::format("\n{}\n", schema["description"].get<std::string>());
      out += kTableHead;
    }
    if (!section)
      out += row(path, schema);
    else if (schema["additionalProperties"].is_object())
      out += row(path + ".NAME", schema["additionalProperties"]);
  });
  return out;
}

}  // namespace carousel
