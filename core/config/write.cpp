#include "core/config/write.h"

#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/config/config.h"

namespace carousel {

using Json = nlohmann::ordered_json;

double shortest(float value) {
  if (!std::isfinite(value)) return value;
  char text[64];
  const auto written = std::to_chars(text, text + sizeof text, value);
  double out = 0;
  std::from_chars(text, written.ptr, out);
  return out;
}

namespace config {

namespace {

/// The visitor that writes the values of the struct it is shown.
class JsonWriter : public RowVisitor<JsonWriter> {
 public:
  template <class T>
  static Json object(T value) {
    JsonWriter writer;
    describe(writer, value);
    return std::move(writer.out_);
  }

  void on_field(std::string_view key, std::int64_t& value, IntRange, const char*, const char*) { put(key, value); }
  void on_field(std::string_view key, float& value, RealRange, const char*, const char*) { put(key, shortest(value)); }
  void on_field(std::string_view key, double& value, RealRange, const char*, const char*) { put(key, value); }
  void on_field(std::string_view key, Vec3& value, RealRange, const char*, const char*) {
    put(key, {shortest(value.x), shortest(value.y), shortest(value.z)});
  }
  void on_field(std::string_view key, GridSize& value, IntRange, const char*, const char*) {
    if (value.any()) put(key, {value.columns, value.rows});
  }
  void on_field(std::string_view key, GraphPoint& value, RealRange, const char*, const char*) {
    if (value.given) put(key, {value.x, value.y});
  }
  void on_field(std::string_view key, bool& value, const char*, const char*) { put(key, value); }
  void on_field(std::string_view key, std::string& value, const char*, const char*) {
    if (!value.empty()) put(key, value);
  }
  void on_field_or_auto(std::string_view key, std::optional<std::int64_t>& value, IntRange, const char*, const char*) {
    put(key, value ? Json(*value) : Json("auto"));
  }
  void on_field_or_auto(std::string_view key, std::optional<float>& value, RealRange, const char*, const char*) {
    put(key, value ? Json(shortest(*value)) : Json("auto"));
  }
  void on_field_or_auto(std::string_view key, std::optional<Vec3>& value, RealRange, const char*, const char*) {
    put(key, value ? Json{shortest(value->x), shortest(value->y), shortest(value->z)} : Json("auto"));
  }
  template <class Key>
  Row own_key(const Key& row, std::optional<std::int64_t>& value) {
    if (value) put(row.name, *value);
    return {};
  }
  template <class E>
  void on_choice(std::string_view key, E& value, const char*) {
    put(key, enum_name(value));
  }
  template <class E>
  void on_choice(std::string_view key, std::optional<E>& value, const char*) {
    if (value) put(key, enum_name(*value));
  }
  template <class T>
  void section(std::string_view key, T& value, const char*) {
    put(key, object(value));
  }
  template <class T>
  void section(std::string_view key, std::optional<T>& value, const char*) {
    if (value) put(key, object(*value));
  }
  void on_section_or_number(std::string_view key, TesterUnits& value, const char*) { put(key, object(value)); }
  template <class T>
  void section_or_choice(std::string_view key, T& value, const char*) {
    put(key, object(value));
  }
  template <class T>
  void section_or_text(std::string_view key, T& value, const char*) {
    put(key, object(value));
  }
  template <class T>
  void list(std::string_view key, std::vector<T>& value, const char*) {
    Json items = Json::array();
    for (const T& item : value) items.push_back(object(item));
    put(key, std::move(items));
  }
  template <class E>
  void choices(std::string_view key, std::vector<E>& value, const char*) {
    Json items = Json::array();
    for (const E item : value) items.push_back(enum_name(item));
    put(key, std::move(items));
  }
  void texts(std::string_view key, std::vector<std::string>& value, const char*) { put(key, value); }
  void effects(std::string_view key, ShadingConfig::Effects& value, const char*) {
    using Choice = ShadingConfig::Effects::Choice;
    put(key, value.choice == Choice::kList ? Json(value.names) : Json(value.choice == Choice::kAuto ? "auto" : "all"));
  }
  void workload(std::string_view key, WorkloadConfig& value, const char*) {
    switch (value.kind) {
      case WorkloadConfig::Kind::kRays:
        return put(key, "rays");
      case WorkloadConfig::Kind::kRaysFrom:
        return put(key, {{"rays_from", value.rays_from}});
      case WorkloadConfig::Kind::kMemoryTrace:
        return put(key, {{"memory_trace", value.memory_trace}});
      case WorkloadConfig::Kind::kTraffic:
        return put(key, {{"traffic", object(value.traffic)}});
      case WorkloadConfig::Kind::kPlugin:
        return put(key, {{"plugin", enum_name(value.own)}, {"options", value.options}});
    }
  }
  void vary(std::string_view key, std::map<std::string, std::vector<std::string>>& value, const char*) {
    put(key, value);
  }
  void others(std::map<std::string, std::int64_t>& value, IntRange, const char*, const char*) {
    for (const auto& [name, number] : value) put(name, number);
  }
  void others(std::map<std::string, double>& value, RealRange, const char*, const char*) {
    for (const auto& [name, number] : value) put(name, number);
  }
  template <class T>
  void members(std::map<std::string, T>& value, const char*) {
    for (const auto& [name, of] : value) put(name, object(of));
  }

 private:
  void put(std::string_view key, Json value) { out_[std::string(key)] = std::move(value); }

  /// Room for the keys of a section from the beginning: an ordered object that grows copies all that it holds.
  static Json with_room() {
    Json out = Json::object();
    out.get_ref<Json::object_t&>().reserve(32);
    return out;
  }

  Json out_ = with_room();
};

bool is_nested(const Json& value) {
  return value.is_object() && !value.empty();
}

std::string yaml_key(const std::string& key) {
  const bool plain = key.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") == key.npos && !key.empty() &&
                     (key[0] < '0' || key[0] > '9');
  return plain ? key : Json(key).dump();  // a JSON string is a double-quoted YAML scalar
}

/// Names that YAML takes for text stay bare; everything else is quoted.
std::string yaml_scalar(const Json& value) {
  if (!value.is_string()) return value.dump();
  const std::string& text = value.get_ref<const std::string&>();
  const bool word = !text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == text.npos &&
                    text != "true" && text != "false" && text != "null";
  return word ? text : value.dump();
}

std::string yaml_flow(const Json& value) {
  std::string out;
  if (value.is_array()) {
    for (const Json& item : value) out += (out.empty() ? "" : ", ") + yaml_flow(item);
    return "[" + out + "]";
  }
  if (value.is_object()) {
    for (const auto& [key, item] : value.items())
      out += (out.empty() ? "" : ", ") + yaml_key(key) + ": " + yaml_flow(item);
    return "{" + out + "}";
  }
  return yaml_scalar(value);
}

void yaml_block(const Json& object, const std::string& indent, std::string& out) {
  constexpr std::size_t kLineLength = 100;
  for (const auto& [key, value] : object.items()) {
    const std::string flow = yaml_flow(value);
    out += indent + yaml_key(key) + ":";
    if (is_nested(value) && indent.size() + key.size() + flow.size() > kLineLength) {
      out += "\n";
      yaml_block(value, indent + "  ", out);
    } else {
      out += " " + flow + "\n";
    }
  }
}

}  // namespace
}  // namespace config

Json config_json(const Config& config) {
  return config::JsonWriter::object(config);
}

std::string yaml_line(const Json& value) {
  return config::yaml_flow(value);
}

std::string resolved_yaml(const Config& config) {
  std::string out;
  config::yaml_block(config_json(config), "", out);
  return out;
}

}  // namespace carousel
