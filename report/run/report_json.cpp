#include "report/run/report_json.h"

#include <algorithm>
#include <cmath>

#include "report/accuracy/accuracy_schema.h"
#include "report/schema/parts.h"
#include "report/sweep/sweep_schema.h"

namespace carousel::report {

using Json = nlohmann::ordered_json;

namespace {

/// Whole numbers are written as such, which takes less room.
Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) {
    const bool whole = std::abs(value) < 0x1p53 && value == std::trunc(value);
    out.push_back(whole ? Json(static_cast<std::int64_t>(value)) : Json(value));
  }
  return out;
}

class JsonWriter {
 public:
  template <class T>
  static Json value_of(const T& value) {
    JsonWriter writer;
    describe(writer, value);
    return std::move(writer.out_);
  }
  template <class T>
  static Json value_of(const std::vector<T>& list) {
    Json out = Json::array();
    for (const T& item : list) out.push_back(value_of(item));
    return out;
  }

  template <class T>
  void field(const char* key, const T& value, const char*, const char*) {
    out_[key] = value;
  }
  template <class T>
  void field(const char* key, const std::optional<T>& value, const char*, const char*) {
    if (value) out_[key] = *value;
  }
  void field(const char* key, const std::vector<double>& values, const char*, const char*) {
    out_[key] = numbers(values);
  }
  template <class T>
  void section(const char* key, const T& value, const char*) {
    out_[key] = value_of(value);
  }
  template <class T>
  void section(const char* key, const std::optional<T>& value, const char*) {
    if (value) out_[key] = value_of(*value);
  }
  template <class T>
  void section_if(bool present, const char* key, const T& value, const char*) {
    if (present) out_[key] = value_of(value);
  }
  void any(const char* key, const Json& value, const char*) { out_[key] = value; }

 private:
  Json out_ = Json::object();
};

Json schema_of(const std::string&) {
  return {{"type", "string"}};
}
Json schema_of(std::string_view) {
  return {{"type", "string"}};
}
Json schema_of(bool) {
  return {{"type", "boolean"}};
}
Json schema_of(double) {
  return {{"type", "number"}};
}
Json schema_of(std::uint64_t) {
  return {{"type", "integer"}, {"minimum", 0}, {"maximum", schema::kMostCount}};
}
Json schema_of(std::int64_t) {
  return {{"type", "integer"}};
}
Json schema_of(const std::vector<std::string>&) {
  return {{"type", "array"}, {"items", {{"type", "string"}}}};
}
Json schema_of(const std::vector<double>&) {
  return {{"type", "array"}, {"items", {{"type", "number"}}}};
}
Json schema_of(const std::array<double, 3>&) {
  return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
}

class SchemaWriter {
 public:
  template <class T>
  static Json schema_for(const T& value) {
    SchemaWriter writer;
    describe(writer, value);
    return {{"type", "object"},
            {"properties", std::move(writer.properties_)},
            {"required", std::move(writer.required_)},
            {"additionalProperties", false}};
  }
  template <class T>
  static Json schema_for(const std::vector<T>&) {
    return {{"type", "array"}, {"items", schema_for(T{})}};
  }

  template <class T>
  void field(const char* key, const T& value, const char* unit, const char* meaning) {
    put(key, schema_of(value), true, unit, meaning);
  }
  template <class T>
  void field(const char* key, const std::optional<T>&, const char* unit, const char* meaning) {
    put(key, schema_of(T{}), false, unit, meaning);
  }
  template <class T>
  void section(const char* key, const T& value, const char* meaning) {
    put(key, schema_for(value), true, "", meaning);
  }
  template <class T>
  void section(const char* key, const std::optional<T>&, const char* meaning) {
    put(key, schema_for(T{}), false, "", meaning);
  }
  template <class T>
  void section_if(bool, const char* key, const T& value, const char* meaning) {
    put(key, schema_for(value), false, "", meaning);
  }
  void any(const char* key, const Json&, const char* meaning) { put(key, {{"type", "object"}}, true, "", meaning); }

 private:
  void put(const char* key, Json schema, bool required, const char* unit, const char* meaning) {
    if (*unit) schema["unit"] = unit;
    schema["description"] = meaning;
    properties_[key] = std::move(schema);
    if (required) required_.push_back(key);
  }

  Json properties_ = Json::object(), required_ = Json::array();
};

void write_text(std::string& out, const Json& json, std::size_t indent) {
  const bool numbers_only =
      json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& item) { return item.is_number(); });
  if (!json.is_structured() || json.empty() || numbers_only) {
    out += json.dump();
    return;
  }
  out += json.is_array() ? '[' : '{';
  const char* separator = "\n";
  for (const auto& [key, value] : json.items()) {
    out.append(separator).append(indent + 2, ' ');
    if (json.is_object()) out += Json(key).dump() + ": ";
    write_text(out, value, indent + 2);
    separator = ",\n";
  }
  out.append("\n").append(indent, ' ') += json.is_array() ? ']' : '}';
}

}  // namespace

std::size_t resources_with_units(const Json& config, std::size_t resources) {
  const auto topology = config.find("topology");
  if (topology == config.end() || topology->value("shape", "") != "graph" || !topology->contains("nodes"))
    return resources;
  std::size_t without = 0;
  for (const Json& node : (*topology)["nodes"]) {
    if (node.value("kind", "") != "packet_process" || node.value("serves", "").empty()) continue;
    const auto count = node.find("count");
    without += count != node.end() && count->is_number() ? count->get<std::size_t>() : 1;
  }
  return resources - std::min(resources, without);
}

std::string json_text(const Json& json) {
  std::string out;
  write_text(out, json, 0);
  return out;
}

Json report_json(const Report& report) {
  return JsonWriter::value_of(report);
}

Json stress_json(const Stress& stress) {
  return JsonWriter::value_of(stress);
}

Json versus_json(const Versus& versus) {
  return JsonWriter::value_of(versus);
}

Json ray_life_json(const RayLife& life) {
  return JsonWriter::value_of(life);
}

Json report_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "Carousel report"},
              {"description",
               "Two runs are identical when all outside of host is equal. Where engine.deterministic is false, "
               "throughput, tests, nodes, packets, collections, resources and links count what the threads happened to "
               "do and may differ between runs; rays, shading, verify and digest may not."}};
  Json run = SchemaWriter::schema_for(Report{});
  schema.update(run);
  schema["$defs"]["sweep"] = sweep_schema();
  run.erase("description");
  schema["$defs"]["point"] = point_schema(std::move(run));
  schema["$defs"]["accuracy"] = accuracy_schema();
  schema["$defs"]["stress"] = SchemaWriter::schema_for(Stress{});
  schema["$defs"]["stress"]["description"] = "stress.json of carousel stress";
  schema["$defs"]["versus"] = SchemaWriter::schema_for(Versus{});
  schema["$defs"]["versus"]["description"] = "versus.json of carousel versus";
  schema["$defs"]["ray_life"] = SchemaWriter::schema_for(RayLife{});
  schema["$defs"]["ray_life"]["description"] = "the life of one ray, as carousel follow --json prints it";
  return schema;
}

}  // namespace carousel::report
