#include "app/usage/usage.h"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/usage/examples.h"
#include "core/config/schema.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

/// The words within {a,b}, as CLI::IsMember describes them behind the name of a type.
std::vector<std::string> words_of(const std::string& type) {
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == type.npos || end == type.npos) return {};
  std::vector<std::string> words;
  for (std::size_t at = begin + 1; at < end;) {
    const std::size_t comma = std::min(type.find(',', at), end);
    words.push_back(type.substr(at, comma - at));
    at = comma + 1;
  }
  return words;
}

Takes taken_by(const std::string& type) {
  static constexpr std::pair<const char*, Takes> kTypes[]{{"FILE", Takes::kFile},
                                                          {"PATH", Takes::kFile},
                                                          {"DIR", Takes::kFolder},
                                                          {"SCENE", Takes::kScene},
                                                          {"KEY=VALUE", Takes::kKeyAndValue},
                                                          {"KEY=VALUES", Takes::kKeyAndValues},
                                                          {"CONDITIONS", Takes::kKeyAndValues}};
  for (const auto& [name, takes] : kTypes)
    if (type == name) return takes;
  return Takes::kText;
}

OptionUsage usage_of(const CLI::Option& option) {
  OptionUsage out;
  out.argument = option.nonpositional() ? false : option.get_positional();
  if (out.argument) {
    out.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  }
  out.meaning = option.get_description();
  if (option.get_items_expected_max() == 0) return out;  // a flag
  const std::string type = option.get_type_name();
  out.value = type.substr(0, type.find(':'));
  out.standard = option.get_default_str();
  out.words = words_of(type);
  out.takes = out.words.empty() ? taken_by(out.value) : Takes::kWords;
  out.list = option.get_delimiter() != '\0';
  out.repeated = option.get_expected_max() > 1;
  return out;
}

std::vector<OptionUsage> options_of(const CLI::App& app) {
  std::vector<OptionUsage> out;
  for (const CLI::Option* option : app.get_options()) out.push_back(usage_of(*option));
  return out;
}

/// The words that a value may be: of an enumeration, a switch, or a text beside numbers, such as auto.
std::vector<std::string> words_of(const Json& schema) {
  if (schema.contains("enum")) return schema["enum"].get<std::vector<std::string>>();
  if (schema.contains("const")) return {schema["const"].get<std::string>()};
  if (schema.contains("type") && schema["type"] == "boolean") return {"true", "false"};
  std::vector<std::string> out;
  if (schema.contains("anyOf"))
    for (const Json& one : schema["anyOf"])
      for (std::string& word : words_of(one)) out.push_back(std::move(word));
  return out;
}

std::string range_of(const Json& schema) {
  if (schema.contains("anyOf"))
    for (const Json& one : schema["anyOf"])
      if (std::string range = range_of(one); !range.empty()) return range;
  if (!schema.contains("maximum")) return "";
  const bool above = schema.contains("exclusiveMinimum");
  return fmt::format("{}{} to {}", above ? "above " : "", schema[above ? "exclusiveMinimum" : "minimum"].dump(),
                     schema["maximum"].dump());
}

}  // namespace

ProgramUsage usage_of(const CLI::App& program) {
  ProgramUsage out{program.get_name(), program.get_description(), options_of(program), {}};
  for (const CLI::App* command : program.get_subcommands({})) {
    CommandUsage usage{command->get_name(), command->get_description(), options_of(*command), {}};
    for (const Example& example : examples())
      if (example.command == usage.name) usage.examples.push_back(example);
    out.commands.push_back(std::move(usage));
  }
  return out;
}

std::vector<KeyUsage> key_usages() {
  std::vector<KeyUsage> out;
  config::walk_schema(config_schema(), [&](const std::string& path, const Json& schema) {
    // Not sections, and not the keys of an item of a list.
    if (schema.contains("properties") || path.find(".0") != path.npos) return;
    KeyUsage key{path, words_of(schema), "", "", schema.value("unit", ""), schema.value("description", "")};
    const std::string words = fmt::format("{}", fmt::join(key.words, ", ")), range = range_of(schema);
    key.values = words.empty() || range.empty() ? words + range : words + ", or " + range;
    if (schema.contains("default"))
      key.standard = schema["default"].is_string() ? schema["default"].get<std::string>() : schema["default"].dump();
    out.push_back(std::move(key));
  });
  return out;
}

}  // namespace carousel::app
