#include "scene/gltf/document/schema.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/system/error.h"
#include "scene/gltf/document/schema_table.h"
#include "scene/gltf/document/uses.h"

namespace carousel::scene {

namespace {

std::string found(const Json& value) {
  switch (value.type()) {
    case Json::value_t::object:
      return "found an object";
    case Json::value_t::array:
      return "found an array of " + std::to_string(value.size());
    case Json::value_t::string: {
      const auto& text = value.get_ref<const std::string&>();
      return text.size() <= 40 ? "found \"" + text + '"'
                               : "found a string of " + std::to_string(text.size()) + " bytes";
    }
    default:
      return "found " + value.dump();
  }
}

/// Writes a whole number as 12, not as 12.0.
std::string shown(double value) {
  if (std::abs(value) < 1e15 && value == std::floor(value)) return std::to_string(static_cast<std::int64_t>(value));
  return Json(value).dump();
}

/// A faulty entry of an array that may hold entries that nobody uses. An empty one stands in its place.
struct Fault {
  std::string array;
  std::size_t index;
  SceneError error;
};

/// The arrays of which only the entries that are used have to be sound, and what stands for a faulty entry.
const std::map<std::string, Json>& lenient_arrays() {
  static const std::map<std::string, Json> arrays{
      {"/textures", Json::object()},
      {"/images", {{"uri", ""}}},
      {"/samplers", Json::object()},
      {"/skins", {{"joints", Json::array()}}},
      {"/animations", {{"channels", Json::array()}, {"samplers", Json::array()}}}};
  return arrays;
}

class Checker {
 public:
  Checker(const GltfDocument& document, const Json& root) : document_(document), root_(root) {}

  Json object(const Json& value, const Schema& schema, const std::string& path) const {
    if (!value.is_object()) fail(value, path, "an object");
    Json out = Json::object();
    for (const SchemaRule& rule : schema) {
      if (rule.posed_only && !document_.posing.on) continue;
      const auto entry = value.find(rule.key);
      const std::string entry_path = json_path(path, rule.key);
      if (entry != value.end()) {
        out[rule.key] = check(*entry, rule, entry_path);
      } else if (rule.required) {
        document_.fail(entry_path, "missing");
      }
    }
    return out;
  }

  const std::vector<Fault>& faults() const { return faults_; }

 private:
  [[noreturn]] void fail(const Json& value, const std::string& path, const std::string& expected) const {
    document_.fail(path, "expected " + expected + ", " + found(value));
  }

  Json check(const Json& value, const SchemaRule& rule, const std::string& path) const {
    switch (rule.kind) {
      case SchemaKind::kBoolean:
        if (!value.is_boolean()) fail(value, path, "true or false");
        return value;
      case SchemaKind::kString:
        if (!value.is_string()) fail(value, path, "a string");
        return value;
      case SchemaKind::kStrings:
        return each(value, path, [&](const Json& v, const std::string& p) {
          if (!v.is_string()) fail(v, p, "a string");
          return v;
        });
      case SchemaKind::kName:
        return name(value, rule, path);
      case SchemaKind::kInteger:
        return integer(value, rule.min, rule.max, path);
      case SchemaKind::kChoice:
        return choice(value, rule, path);
      case SchemaKind::kNumber:
        return number(value, rule, path);
      case SchemaKind::kNumbers: {
        if (value.is_array() && rule.length != 0 && value.size() != rule.length) {
          fail(value, path, "an array of " + std::to_string(rule.length) + " numbers");
        }
        return each(value, path, [&](const Json& v, const std::string& p) { return number(v, rule, p); });
      }
      case SchemaKind::kIndex:
        return index(value, rule, path);
      case SchemaKind::kIndices:
        return each(value, path, [&](const Json& v, const std::string& p) { return index(v, rule, p); });
      case SchemaKind::kIndexMap:
        return index_map(value, rule, path);
      case SchemaKind::kIndexMaps:
        return each(value, path, [&](const Json& v, const std::string& p) { return index_map(v, rule, p); });
      case SchemaKind::kIntegerMap: {
        if (!value.is_object()) fail(value, path, "an object");
        Json out = Json::object();
        for (const auto& [key, v] : value.items()) out[key] = integer(v, rule.min, rule.max, json_path(path, key));
        return out;
      }
      case SchemaKind::kExtras:
        return value.is_object() ? object(value, *rule.child, path) : Json::object();
      case SchemaKind::kObject:
        return object(value, *rule.child, path);
      case SchemaKind::kObjects:
        if (const auto lenient = lenient_arrays().find(path); lenient != lenient_arrays().end())
          return each_leniently(value, *rule.child, path, lenient->second);
        return each(value, path, [&](const Json& v, const std::string& p) { return object(v, *rule.child, p); });
    }
    return {};
  }

  Json index_map(const Json& value, const SchemaRule& rule, const std::string& path) const {
    if (!value.is_object()) fail(value, path, "an object");
    Json out = Json::object();
    for (const auto& [key, v] : value.items()) out[key] = index(v, rule, json_path(path, key));
    return out;
  }

  template <class Check>
  Json each(const Json& value, const std::string& path, const Check& check_one) const {
    if (!value.is_array()) fail(value, path, "an array");
    Json out = Json::array();
    out.get_ref<Json::array_t&>().reserve(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) out.push_back(check_one(value[i], json_path(path, i)));
    return out;
  }

  Json each_leniently(const Json& value, const Schema& schema, const std::string& path, const Json& substitute) const {
    std::size_t index = 0;
    return each(value, path, [&](const Json& v, const std::string& p) {
      const std::size_t at = index++;
      try {
        return object(v, schema, p);
      } catch (const SceneError& error) {
        faults_.push_back({path, at, error});
        return substitute;
      }
    });
  }

  Json name(const Json& value, const SchemaRule& rule, const std::string& path) const {
    if (value.is_string() && std::ranges::find(rule.names, value.get_ref<const std::string&>()) != rule.names.end()) {
      return value;
    }
    std::string expected = "one of";
    for (const std::string& n : rule.names) expected += ' ' + n;
    fail(value, path, expected);
  }

  /// glTF allows a whole number to be written with a fraction of zero.
  Json integer(const Json& value, double min, double max, const std::string& path) const {
    if (value.is_number()) {
      const double v = value.get<double>();
      if (v == std::floor(v) && v >= min && v <= max) return static_cast<std::int64_t>(v);
    }
    fail(value, path,
         max >= 9e15 ? "an integer of at least " + shown(min) : "an integer from " + shown(min) + " to " + shown(max));
  }

  Json choice(const Json& value, const SchemaRule& rule, const std::string& path) const {
    if (value.is_number()) {
      const double v = value.get<double>();
      for (const int c : rule.choices) {
        if (v == c) return c;
      }
    }
    std::string expected = "one of";
    for (const int c : rule.choices) expected += ' ' + std::to_string(c);
    fail(value, path, expected);
  }

  Json number(const Json& value, const SchemaRule& rule, const std::string& path) const {
    if (!value.is_number()) fail(value, path, "a number");
    const double v = value.get<double>();
    if (!(v >= rule.min && v <= rule.max))
      fail(value, path, "a number from " + shown(rule.min) + " to " + shown(rule.max));
    return v;  // always a double: tinygltf cuts large integers in extensions down to 32 bits
  }

  Json index(const Json& value, const SchemaRule& rule, const std::string& path) const {
    const std::size_t size = size_of(rule.refers_to);
    if (value.is_number()) {
      const double v = value.get<double>();
      if (v == std::floor(v) && v >= 0 && v < static_cast<double>(size)) return static_cast<std::int64_t>(v);
    }
    fail(value, path,
         "an index into " + std::string(rule.refers_to) + ", which has " + std::to_string(size) +
             (size == 1 ? " entry" : " entries"));
  }

  std::size_t size_of(const char* array_path) const {
    const Json::json_pointer pointer(array_path);
    if (!root_.contains(pointer)) return 0;
    const Json& array = root_.at(pointer);
    return array.is_array() ? array.size() : 0;
  }

  const GltfDocument& document_;
  const Json& root_;
  mutable std::vector<Fault> faults_;
};

}  // namespace

void check_schema(GltfDocument& document, const WarningSink& warn) {
  // This check comes first: otherwise an index into a value that is no array would get the blame.
  for (const SchemaRule& rule : gltf_schema()) {
    const auto entry = document.json.find(rule.key);
    if (rule.kind == SchemaKind::kObjects && entry != document.json.end() && !entry->is_array()) {
      document.fail(json_path("", rule.key), "expected an array, " + found(*entry));
    }
  }
  const Checker checker(document, document.json);
  Json checked = checker.object(document.json, gltf_schema(), "");
  const Uses uses = uses_of(checked, document.posing);
  for (const Fault& fault : checker.faults()) {
    const bool used = fault.array == "/textures"   ? uses.textures[fault.index]
                      : fault.array == "/images"   ? uses.images[fault.index]
                      : fault.array == "/samplers" ? uses.samplers[fault.index]
                      : fault.array == "/skins"    ? uses.skins[fault.index]
                                                   : uses.animations[fault.index];
    if (used) throw fault.error;
    if (warn) warn(std::string(fault.error.what()) + "; ignored, since nothing that is shown uses it");
  }
  document.json = std::move(checked);
}

}  // namespace carousel::scene
