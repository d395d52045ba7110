#include "app/sweep/plan/axis.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/schema.h"
#include "core/system/error.h"
#include "core/text/edit_distance.h"

namespace carousel::app {

namespace {

constexpr std::size_t kMostRangeValues = 100'000;  // most values of one range: more is a slip of the pen

[[noreturn]] void fail(const std::string& where, const std::string& key, const std::string& message) {
  throw ConfigError({{{where, 0, 0}, key, message}});
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == text.npos ? "" : text.substr(first, last - first + 1);
}

bool is_integer(const std::string& text) {
  return !text.empty() && text.find_first_not_of("-0123456789") == text.npos;
}

/// True if the schema says that the key takes integers; where it does not know the key, the ends of the range decide.
bool takes_integers(const std::string& key, bool ends_are_integers) {
  static const nlohmann::ordered_json schema = config_schema();
  const nlohmann::ordered_json* at = &schema;
  for (const std::string& name : split_outside(key, '.')) {
    if (at->contains("anyOf")) at = &(*at)["anyOf"][0];  // a section that may be a bare number
    if (!at->contains("properties") || !(*at)["properties"].contains(name)) return ends_are_integers;
    at = &(*at)["properties"][name];
  }
  const std::string text = at->dump();
  return text.find("\"integer\"") != text.npos && text.find("\"number\"") == text.npos;
}

std::string number_text(double value, bool integral) {
  return integral ? fmt::format("{}", std::llround(value)) : fmt::format("{:.7g}", value);
}

/// The values of one text: a range, or the text itself.
std::vector<std::string> expand(const std::string& text, const std::string& key, const std::string& where,
                                std::optional<Axis::Span>& span) {
  static const std::regex range(
      R"((log:)?(-?[0-9.]+(?:e[-+]?\d+)?)\.\.(-?[0-9.]+(?:e[-+]?\d+)?)(?:([*+:])([0-9.]+))?)");
  std::smatch m;
  if (text.find("..") == text.npos || !std::regex_match(text, m, range)) return {text};
  const auto low = number_of(m[2]), high = number_of(m[3]);
  if (!low || !high || *low > *high) fail(where, key, fmt::format("expected a range low..high, found '{}'", text));
  const bool logarithmic = m[1].matched;
  const std::string kind = m[4];
  const bool integral = takes_integers(key, is_integer(m[2]) && is_integer(m[3]));
  const double step = m[5].matched ? number_of(m[5]).value_or(0) : 1;
  if (logarithmic && (kind != ":" || *low <= 0))
    fail(where, key,
         fmt::format("expected log:low..high:count with low above 0, found '{}'; as in log:64..4096:7", text));
  std::vector<double> values;
  if (kind == ":") {
    if (step < 1 || step > kMostRangeValues || step != std::floor(step))
      fail(where, key, fmt::format("expected a number of values of 1 or more behind the colon, found '{}'", text));
    span = {*low, *high, logarithmic, integral};
    for (int i = 0; i < static_cast<int>(step); ++i) {
      const double part = step == 1 ? 0 : i / (step - 1);
      values.push_back(logarithmic ? *low * std::pow(*high / *low, part) : *low + part * (*high - *low));
    }
  } else {
    if ((kind == "*" && (step <= 1 || *low <= 0)) || step <= 0)
      fail(where, key, fmt::format("expected a step that leads from the low end to the high one, found '{}'", text));
    for (double v = *low; v <= *high * (1 + 1e-12) && values.size() <= kMostRangeValues;
         v = kind == "*" ? v * step : v + step)
      values.push_back(v);
    if (values.size() > kMostRangeValues)
      fail(where, key, fmt::format("'{}' has more than {} values", text, kMostRangeValues));
  }
  std::vector<std::string> out;
  for (const double value : values) {
    std::string shown = number_text(value, integral);
    if (out.empty() || out.back() != shown) out.push_back(std::move(shown));  // rounded values may coincide
  }
  return out;
}

bool compares(double order, const std::string& comparison) {
  if (comparison == "=") return order == 0;
  if (comparison == "!=") return order != 0;
  if (comparison == "<") return order < 0;
  if (comparison == "<=") return order <= 0;
  return comparison == ">" ? order > 0 : order >= 0;
}

}  // namespace

std::optional<double> number_of(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string> split_outside(const std::string& text, char separator) {
  std::vector<std::string> out(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '(' || c == '[' || c == '{') {
      ++depth;
    } else if (c == ')' || c == ']' || c == '}') {
      --depth;
    }
    if (c == separator && depth == 0 && quote == 0)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

std::string Axis::Span::at(double part) const {
  return number_text(logarithmic ? low * std::pow(high / low, part) : low + part * (high - low), integral);
}

Axis make_axis(const std::string& keys, const std::vector<std::string>& values, const std::string& where) {
  Axis axis;
  for (const std::string& key : split_outside(keys, ',')) axis.keys.push_back(trimmed(key));
  for (const std::string& key : axis.keys) {
    const std::vector<std::string>& known = config::config_key_paths();
    if (key == "image.seed" || std::find(known.begin(), known.end(), key) != known.end()) continue;
    if (key.find_first_of("0123456789") != key.npos && key.find('.') != key.npos) continue;  // an entry of a list
    const auto near = nearest_name(key, known);
    fail(where, key, fmt::format("unknown key{}", near ? "; did you mean '" + *near + "'?" : ""));
  }
  const auto add = [&](std::vector<std::string> level) {
    if (std::find(axis.levels.begin(), axis.levels.end(), level) != axis.levels.end())
      fail(where, keys, fmt::format("expected each value once, found {} twice", fmt::join(level, ", ")));
    axis.levels.push_back(std::move(level));
  };
  for (const std::string& text : values) {
    const std::string value = trimmed(text);
    if (value.empty()) fail(where, keys, "expected values behind the equals sign; one of them is empty");
    if (axis.keys.size() == 1) {
      for (std::string& one : expand(value, axis.keys[0], where, axis.span)) add({std::move(one)});
      continue;
    }
    const bool bracketed = value.front() == '(' && value.back() == ')';
    std::vector<std::string> level = split_outside(bracketed ? value.substr(1, value.size() - 2) : value, ',');
    for (std::string& part : level) part = trimmed(part);
    if (!bracketed || level.size() != axis.keys.size())
      fail(where, keys,
           fmt::format("expected {} values in brackets, one for each key, found '{}'", axis.keys.size(), value));
    add(std::move(level));
  }
  if (values.size() != 1) axis.span.reset();  // a list of ranges is a list
  return axis;
}

Axis parse_axis(const std::string& text) {
  const std::string where = "--vary " + text;
  const std::size_t equals = text.find('=');
  if (equals == text.npos || equals == 0)
    fail(where, "", "expected key.path=values, as in topology.resources=2,4,8 or memory.l2_kib=log:64..4096:7");
  return make_axis(text.substr(0, equals), split_outside(text.substr(equals + 1), ','), where);
}

Axis scene_axis(const std::vector<std::string>& scenes) {
  Axis axis{{"scene"}, {}, {}};
  for (const std::string& scene : scenes) axis.levels.push_back({scene});
  return axis;
}

bool Exclusion::holds(const std::vector<KeyValue>& point) const {
  return std::all_of(conditions.begin(), conditions.end(), [&](const Condition& c) {
    const auto at = std::find_if(point.begin(), point.end(), [&](const KeyValue& k) { return k.first == c.key; });
    if (at == point.end()) return false;
    const auto a = number_of(at->second), b = number_of(c.value);
    return compares(a && b ? *a - *b : at->second.compare(c.value), c.comparison);
  });
}

Exclusion parse_exclusion(const std::string& text, const std::vector<Axis>& axes) {
  const std::string where = "--exclude " + text;
  static const std::regex condition(R"(\s*([^=<>!\s]+)\s*(=|!=|<=|>=|<|>)\s*(.*?)\s*)");
  std::vector<std::string> keys;
  for (const Axis& axis : axes) keys.insert(keys.end(), axis.keys.begin(), axis.keys.end());
  Exclusion out;
  for (const std::string& part : split_outside(text, ',')) {
    std::smatch m;
    if (!std::regex_match(part, m, condition))
      fail(where, "", "expected conditions on varied keys, as in topology.resources=64,memory.l2_kib<=128");
    if (std::find(keys.begin(), keys.end(), m[1]) == keys.end())
      fail(where, m[1], fmt::format("expected a key that varies, which are {}", fmt::join(keys, ", ")));
    out.conditions.push_back({m[1], m[2], m[3]});
  }
  return out;
}

}  // namespace carousel::app
