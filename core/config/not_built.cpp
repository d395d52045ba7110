#include "core/config/not_built.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/row_walk.h"
#include "core/config/schema.h"
#include "core/config/write.h"

namespace carousel {

namespace {

using Json = nlohmann::ordered_json;
using enum NotBuilt::Without;
using config::RowWalk;

/// The visitor of rows that only one engine has.
class EngineRows : public RowWalk<EngineRows> {
 public:
  template <class T>
  struct Rest {
    EngineRows& rows;
    std::string path;

    template <class... Args>
    Rest relax(const Args&...) const {
      return *this;
    }
    template <class... Values>
    Rest only(EngineKind engine, const char* thing, Values... values) const {
      if (rows.in_override()) return *this;
      const NotBuilt::Without without = engine == EngineKind::kCycle ? kNative : kCycle;
      if constexpr (sizeof...(values) == 0) rows.table.push_back({path, "", without, thing});
      (rows.table.push_back({path, text(values), without, thing}), ...);
      return *this;
    }

   private:
    static std::string text(bool value) { return value ? "true" : "false"; }
    template <class E>
    static std::string text(E value) {
      return std::string(enum_name(value));
    }
  };
  template <class T>
  Rest<T> rest(std::string path, T&) {
    return {*this, std::move(path)};
  }

  using RowWalk::in_override;
  std::vector<NotBuilt> table;
};

const std::vector<NotBuilt>& table() {
  static const std::vector<NotBuilt> rows = [] {
    EngineRows walk;
    Config config;
    describe(walk, config);
    return std::move(walk.table);
  }();
  return rows;
}

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// The value at `path`; null if it is absent.
const Json* find(const Json& config, std::string_view path) {
  const Json* at = &config;
  while (at != nullptr && !path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const auto found = at->find(std::string(path.substr(0, dot)));
    at = found == at->end() ? nullptr : &*found;
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return at;
}

std::optional<std::string> default_of(std::string_view key) {
  static const Json defaults = config_json(Config{});
  const Json* value = find(defaults, key);
  return value == nullptr ? std::nullopt : std::optional(text_of(*value));
}

bool lacks(const NotBuilt& row, EngineKind engine) {
  return row.without == kBoth || row.without == (engine == EngineKind::kNative ? kNative : kCycle);
}

bool means(const NotBuilt& row, std::string_view key, std::string_view value) {
  if (row.key != key) return false;
  return row.value.empty() ? value != default_of(key) : value == row.value;
}

bool takes(EngineKind engine, std::string_view key, std::string_view value) {
  for (const NotBuilt& row : table())
    if (lacks(row, engine) && means(row, key, value)) return false;
  return true;
}

/// "a, b or c": the values that the engine takes instead.
std::string instead(EngineKind engine, std::string_view key) {
  std::vector<std::string> values;
  for (std::string& value : config::enum_values(key))
    if (takes(engine, key, value)) values.push_back(std::move(value));
  if (values.empty()) return default_of(key).value_or("no value");
  std::string out = values[0];
  for (std::size_t i = 1; i < values.size(); ++i) out += (i + 1 < values.size() ? ", " : " or ") + values[i];
  return out;
}

}  // namespace

std::span<const NotBuilt> not_built() {
  return table();
}

namespace config {

std::vector<EngineKind> engines_with(std::string_view key, std::string_view value) {
  std::vector<EngineKind> out;
  for (const auto& [engine, name] : kEnumNames<EngineKind>)
    if (takes(engine, key, value)) out.push_back(engine);
  return out;
}

std::vector<Refusal> refusals(const Config& config) {
  const EngineKind engine = config.engine.kind;
  const Json values = config_json(config);
  std::vector<Refusal> out;
  const auto check = [&](const Json& below, const NotBuilt& row, const std::string& key) {
    const Json* value = find(below, row.key);
    if (value == nullptr || !means(row, row.key, text_of(*value))) return;
    const std::string found = text_of(*value), thing = row.thing.empty() ? found : std::string(row.thing);
    std::string message = row.without == kBoth ? thing + " is not built yet"
                                               : fmt::format("the {} engine has no {}", enum_name(engine), thing);
    message += "; expected " + instead(engine, row.key);
    if (!row.thing.empty()) message += ", found " + found;
    out.push_back({key, std::move(message)});
  };
  for (const NotBuilt& row : table()) {
    if (!lacks(row, engine)) continue;
    check(values, row, std::string(row.key));
    if (!row.key.starts_with("testers.")) continue;
    for (const char* list : {"overrides", "nodes"}) {
      const Json& items = values["topology"][list];
      for (std::size_t i = 0; i < items.size(); ++i) {
        const Json* own = find(items[i], row.key);
        if (own != nullptr && *own != *find(values, row.key))  // not inherited from the whole machine
          check(items[i], row, fmt::format("topology.{}.{}.{}", list, i, row.key));
      }
    }
  }
  return out;
}

}  // namespace config
}  // namespace carousel
