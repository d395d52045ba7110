#include "core/config/schema.h"

#include <algorithm>
#include <map>
#include <mutex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/config.h"
#include "core/config/not_built.h"
#include "core/config/write.h"
#include "core/types/added_names.h"
#include "core/types/effect.h"
#include "core/types/workload_offer.h"

namespace carousel {

using Json = nlohmann::ordered_json;

namespace config {

namespace {

/// The visitor that writes the schema of the struct it is shown, with that struct's values as defaults.
class SchemaWriter : public RowVisitor<SchemaWriter> {
 public:
  template <class T>
  static Json object(T value, const char* meaning) {
    SchemaWriter writer;
    describe(writer, value);
    Json out{{"type", "object"}};
    if (*meaning) out["description"] = meaning;
    out["properties"] = std::move(writer.properties_);
    out["additionalProperties"] = std::move(writer.others_);
    return out;
  }

  void on_field(std::string_view key, std::int64_t& value, IntRange range, const char* unit, const char* meaning) {
    Json out = integer(range);
    out["default"] = value;
    put(key, std::move(out), unit, meaning);
  }
  void on_field(std::string_view key, float& value, RealRange range, const char* unit, const char* meaning) {
    Json out = real(range);
    out["default"] = shortest(value);
    put(key, std::move(out), unit, meaning);
  }
  void on_field(std::string_view key, double& value, RealRange range, const char* unit, const char* meaning) {
    Json out = real(range);
    out["default"] = value;
    put(key, std::move(out), unit, meaning);
  }
  void on_field(std::string_view key, Vec3& value, RealRange range, const char* unit, const char* meaning) {
    Json out = vector(range);
    out["default"] = {shortest(value.x), shortest(value.y), shortest(value.z)};
    put(key, std::move(out), unit, meaning);
  }
  void on_field(std::string_view key, GridSize&, IntRange range, const char* unit, const char* meaning) {
    put(key, {{"type", "array"}, {"items", integer(range)}, {"minItems", 2}, {"maxItems", 2}}, unit, meaning);
  }
  void on_field(std::string_view key, GraphPoint&, RealRange range, const char* unit, const char* meaning) {
    put(key, {{"type", "array"}, {"items", real(range)}, {"minItems", 2}, {"maxItems", 2}}, unit, meaning);
  }
  void on_field(std::string_view key, bool& value, const char* unit, const char* meaning) {
    put(key, {{"type", "boolean"}, {"default", value}}, unit, meaning);
  }
  void on_field(std::string_view key, std::string&, const char* unit, const char* meaning) {
    put(key, {{"type", "string"}, {"minLength", 1}}, unit, meaning);
  }
  void on_field_or_auto(std::string_view key, std::optional<std::int64_t>&, IntRange range, const char* unit,
                        const char* meaning) {
    put(key, or_auto(integer(range)), unit, meaning);
  }
  void on_field_or_auto(std::string_view key, std::optional<float>&, RealRange range, const char* unit,
                        const char* meaning) {
    put(key, or_auto(real(range)), unit, meaning);
  }
  void on_field_or_auto(std::string_view key, std::optional<Vec3>&, RealRange range, const char* unit,
                        const char* meaning) {
    put(key, or_auto(vector(range)), unit, meaning);
  }
  template <class E>
  void on_choice(std::string_view key, E& value, const char* meaning) {
    put(key, {{"enum", names<E>()}, {"default", enum_name(value)}}, "", meaning);
  }
  template <class E>
  void on_choice(std::string_view key, std::optional<E>&, const char* meaning) {
    put(key, {{"enum", names<E>()}}, "", meaning);
  }
  template <class T>
  void section(std::string_view key, T& value, const char* meaning) {
    properties_[std::string(key)] = object(value, meaning);
  }
  template <class T>
  void section(std::string_view key, std::optional<T>&, const char* meaning) {
    properties_[std::string(key)] = object(T{}, meaning);
  }
  void on_section_or_number(std::string_view key, TesterUnits& value, const char* meaning) {
    const Json section = object(value, "");
    Json units = section["properties"]["units"];
    units.erase("default");
    put(key, {{"anyOf", {section, std::move(units)}}}, "", meaning);
  }
  template <class T>
  void section_or_choice(std::string_view key, T& value, const char* meaning) {
    const Json section = object(value, "");
    Json word = section["properties"]["hits"];
    for (const char* shown : {"default", "description"}) word.erase(shown);
    put(key, {{"anyOf", {section, std::move(word)}}}, "", meaning);
  }
  template <class T>
  void section_or_text(std::string_view key, T& value, const char* meaning) {
    const Json section = object(value, "");
    put(key, {{"anyOf", {section, Json{{"type", "string"}, {"minLength", 1}}}}}, "", meaning);
  }
  template <class T>
  void list(std::string_view key, std::vector<T>&, const char* meaning) {
    Json item = object(T{}, "");
    if (!T::kRequired.empty()) item["required"] = Json::array({std::string(T::kRequired)});
    put(key, {{"type", "array"}, {"items", std::move(item)}, {"default", Json::array()}}, "", meaning);
  }
  template <class E>
  void choices(std::string_view key, std::vector<E>& value, const char* meaning) {
    Json standard = Json::array();
    for (const E item : value) standard.push_back(enum_name(item));
    put(key, {{"type", "array"}, {"items", {{"enum", names<E>()}}}, {"default", std::move(standard)}}, "", meaning);
  }
  void texts(std::string_view key, std::vector<std::string>&, const char* meaning) {
    put(key, {{"type", "array"}, {"items", {{"type", "string"}, {"minLength", 1}}}, {"default", Json::array()}}, "",
        meaning);
  }
  void effects(std::string_view key, ShadingConfig::Effects&, const char* meaning) {
    put(key,
        {{"anyOf", {Json{{"enum", {"auto", "all"}}}, Json{{"type", "array"}, {"items", {{"enum", kEffectNames}}}}}},
         {"default", "auto"}},
        "", meaning);
  }
  void workload(std::string_view key, WorkloadConfig& value, const char* meaning) {
    const auto one_key = [](const char* name, Json schema) {
      return Json{{"type", "object"},
                  {"properties", {{name, std::move(schema)}}},
                  {"required", {name}},
                  {"additionalProperties", false}};
    };
    const auto file = [](const char* text) {
      return Json{{"type", "string"}, {"minLength", 1}, {"description", text}};
    };
    Json rays =
        one_key("rays_from",
                file("A file of rays in CSV. Its path is relative to the config's folder, then to the working one."));
    Json trace =
        one_key("memory_trace",
                file("A file of requests to the memory in CSV (docs/how-it-works/memory.md); the memory runs alone."));
    Json all = Json::array({Json{{"const", "rays"}}, std::move(rays), std::move(trace),
                            one_key("traffic", object(value.traffic, "Synthetic packets."))});
    const Json any_options{{"type", "object"}, {"additionalProperties", {{"type", "number"}}}};
    const auto plugin = [&](Json name, Json options) {
      name["description"] = "A workload that one of engine.plugins brings.";
      options["description"] = "Numbers that this workload takes; docs/guides/plugins.md.";
      all.push_back({{"type", "object"},
                     {"properties", {{"plugin", std::move(name)}, {"options", std::move(options)}}},
                     {"required", {"plugin"}},
                     {"additionalProperties", false}});
    };
    const auto brought = all_named_values<OwnWorkload>();
    for (const auto& [name, own] : brought) plugin({{"const", name}}, options_of(own));
    if (brought.empty()) plugin({{"type", "string"}, {"minLength", 1}}, any_options);
    put(key, {{"anyOf", std::move(all)}, {"default", "rays"}}, "", meaning);
  }
  void others(std::map<std::string, std::int64_t>&, IntRange range, const char* unit, const char* meaning) {
    others_ = integer(range);
    others_["unit"] = unit;
    others_["description"] = meaning;
  }
  void others(std::map<std::string, double>&, RealRange range, const char* unit, const char* meaning) {
    others_ = real(range);
    if (*unit) others_["unit"] = unit;
    others_["description"] = meaning;
  }
  template <class T>
  void members(std::map<std::string, T>&, const char* meaning) {
    others_ = object(T{}, meaning);
  }
  void vary(std::string_view key, std::map<std::string, std::vector<std::string>>&, const char* meaning) {
    const Json scalar{{"type", {"string", "number", "boolean"}}};
    put(key,
        {{"type", "object"},
         {"additionalProperties", {{"anyOf", {scalar, Json{{"type", "array"}, {"items", scalar}, {"minItems", 1}}}}}},
         {"default", Json::object()}},
        "", meaning);
  }

 private:
  static Json or_auto(Json schema) {
    return {{"anyOf", {Json{{"const", "auto"}}, std::move(schema)}}, {"default", "auto"}};
  }
  static Json vector(RealRange range) {
    return {{"type", "array"}, {"items", real(range)}, {"minItems", 3}, {"maxItems", 3}};
  }
  static Json integer(IntRange range) { return {{"type", "integer"}, {"minimum", range.min}, {"maximum", range.max}}; }
  static Json real(RealRange range) {
    return {{"type", "number"}, {range.above_min ? "exclusiveMinimum" : "minimum", range.min}, {"maximum", range.max}};
  }
  template <class E>
  static std::vector<std::string> names() {
    std::vector<std::string> out;
    for (const auto& [name, value] : all_named_values<E>())
      if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
    return out;
  }
  static Json options_of(OwnWorkload own) {
    Json properties = Json::object();
    if (const auto* offer = added_body<WorkloadOffer>(own))
      for (const WorkloadOption& option : offer->options) {
        Json& of = properties[option.name] = real({option.least, option.most});
        of["default"] = option.standard;
        if (!option.unit.empty()) of["unit"] = option.unit;
        of["description"] = option.meaning;
      }
    return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  }
  void put(std::string_view key, Json schema, const char* unit, const char* meaning) {
    if (*unit) schema["unit"] = unit;
    schema["description"] = meaning;
    properties_[std::string(key)] = std::move(schema);
  }

  Json properties_ = Json::object(), others_ = false;
};

using VisitKey = std::function<void(const std::string&, const Json&)>;

void walk(const Json& schema, const std::string& path, const VisitKey& visit) {
  if (const auto alternatives = schema.find("anyOf"); alternatives != schema.end())
    for (const Json& alternative : *alternatives) walk(alternative, path, visit);
  if (const auto items = schema.find("items"); items != schema.end()) walk(*items, path + ".0", visit);
  const auto properties = schema.find("properties");
  if (properties == schema.end()) return;
  for (const auto& [key, value] : properties->items()) {
    const std::string child = path.empty() ? key : path + "." + key;
    visit(child, value);
    walk(value, child, visit);
  }
  if (const auto others = schema.find("additionalProperties"); others != schema.end() && others->is_object())
    walk(*others, path + ".NAME", visit);
}

/// Writes beside each enumeration, and each other key of the table, which engines take the values that not all take.
void add_engines(Json& schema) {
  for (const NotBuilt& row : not_built()) {
    Json* at = &schema;
    std::string_view key = row.key;
    while (!key.empty()) {
      const std::size_t dot = std::min(key.find('.'), key.size());
      at = &(*at)["properties"][std::string(key.substr(0, dot))];
      key.remove_prefix(std::min(dot + 1, key.size()));
    }
    Json& engines = (*at)["engines"];
    const auto add = [&](const std::string& value, const std::vector<EngineKind>& having) {
      if (having.size() == kEnumNames<EngineKind>.size()) return;
      engines[value] = Json::array();
      for (const EngineKind engine : having) engines[value].push_back(enum_name(engine));
    };
    if (at->contains("enum"))
      for (const Json& value : (*at)["enum"]) add(value, engines_with(row.key, value.get<std::string>()));
    else if (row.value.empty())
      add("others than the default", engines_with(row.key, ""));
    else
      add(std::string(row.value), engines_with(row.key, row.value));
  }
}

}  // namespace

void walk_schema(const Json& schema, const VisitKey& visit) {
  walk(schema, "", visit);
}

namespace {

/// What the schema says, put together once: a file may hold thousands of unknown keys.
struct SchemaFacts {
  std::map<std::string, std::vector<std::string>, std::less<>> values;  // by key, of enumerations
  std::vector<std::string> paths;
};

/// The facts of the schema with the names that are known now. What it returns stays where it is.
const SchemaFacts& schema_facts() {
  static std::mutex mutex;
  static std::map<std::size_t, SchemaFacts> facts;  // by the number of names that plugins have added
  const std::size_t added = added_in_all();
  const std::lock_guard lock(mutex);
  const auto found = facts.find(added);
  if (found != facts.end()) return found->second;
  SchemaFacts& out = facts[added];
  walk(config_schema(), "", [&](const std::string& key, const Json& schema) {
    out.paths.push_back(key);
    if (schema.contains("enum")) out.values[key] = schema["enum"].get<std::vector<std::string>>();
  });
  return out;
}

}  // namespace

std::vector<std::string> enum_values(std::string_view path) {
  const auto& values = schema_facts().values;
  const auto found = values.find(path);
  return found == values.end() ? std::vector<std::string>{} : found->second;
}

const std::vector<std::string>& config_key_paths() {
  return schema_facts().paths;
}

std::optional<std::string> config_path_ending_in(std::string_view key) {
  const std::string ending = "." + std::string(key);
  std::optional<std::string> best;
  for (const std::string& path : config_key_paths()) {
    if (path.size() <= ending.size() || path.compare(path.size() - ending.size(), ending.size(), ending) != 0) continue;
    if (!best || path.size() < best->size()) best = path;
  }
  return best;
}

}  // namespace config

Json config_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Carousel configuration"}};
  schema.update(config::SchemaWriter::object(Config{}, ""));
  // Not a key of the configuration: the line that tells editors of this schema.
  schema["patternProperties"] = {{"^\\$schema$", {{"type", "string"}}}};
  schema["required"] = {"scene"};
  Json& scene = schema["properties"]["scene"];
  scene["oneOf"] = {Json{{"required", {"file"}}}, Json{{"required", {"builtin"}}}};
  config::add_engines(schema);
  return schema;
}

}  // namespace carousel
