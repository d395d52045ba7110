#include "core/config/reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/config/schema.h"
#include "core/text/edit_distance.h"
#include "core/types/workload_offer.h"

namespace carousel::config {

namespace {

std::string with_unit(const char* unit) {
  return *unit ? fmt::format(" ({})", unit) : "";
}

std::string expected_integer(IntRange range, const char* unit) {
  if (range.min == range.max) return std::to_string(range.min);
  return fmt::format("an integer from {} to {}{}", range.min, range.max, with_unit(unit));
}

std::string expected_real(RealRange range, const char* unit) {
  return fmt::format("a number {}{} to {:g}{}", range.above_min ? "above " : "from ", range.min, range.max,
                     with_unit(unit));
}

std::optional<std::int64_t> integer_of(const Node& node, IntRange range) {
  if (node.kind != Node::Kind::kInt) return std::nullopt;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(node.text.data(), node.text.data() + node.text.size(), value);
  if (error != std::errc{} || value < range.min || value > range.max) return std::nullopt;
  return value;
}

template <class Real>
std::optional<Real> real_of(const Node& node, RealRange range) {
  if (node.kind != Node::Kind::kInt && node.kind != Node::Kind::kFloat) return std::nullopt;
  Real value = 0;
  const auto [end, error] = std::from_chars(node.text.data(), node.text.data() + node.text.size(), value);
  // Written so that NaN is refused.
  const bool inside = (range.above_min ? value > range.min : value >= range.min) && value <= range.max;
  if (error != std::errc{} || !inside) return std::nullopt;
  return value;
}

std::string join(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The keys of a section; of a long one those that are nearest to the unknown key.
std::string known_text(const std::string& unknown, std::vector<std::string> known) {
  constexpr std::size_t kShown = 12, kLongest = 64;
  if (known.size() <= kShown) return "known here: " + join(known);
  const std::size_t all = known.size();
  const std::string_view name = std::string_view(unknown).substr(0, kLongest);
  std::stable_sort(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(name, a) < edit_distance(name, b);
  });
  known.resize(kShown);
  return fmt::format("of the {} keys known here the nearest are {}", all, join(known));
}

bool is_scalar(const Node& node) {
  return node.kind != Node::Kind::kSeq && node.kind != Node::Kind::kMap && node.kind != Node::Kind::kNull;
}

}  // namespace

Reader::Visit::Visit(Reader& r, std::string_view key) : reader(r), node(r.scopes_.back().node->find(key)) {
  r.scopes_.back().known.emplace_back(key);
  r.path_.emplace_back(key);
}

std::string Reader::path() const {
  return fmt::format("{}", fmt::join(path_, "."));
}

void Reader::wrong(const Node& node, const std::string& expected, const std::string& hint) {
  issues_.push_back({node.position, path(), fmt::format("expected {}, found {}{}", expected, node.found(), hint)});
}

void Reader::on_field(std::string_view key, std::int64_t& value, IntRange range, const char* unit, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (const auto number = integer_of(*visit.node, range))
    value = *number;
  else
    wrong(*visit.node, expected_integer(range, unit));
}

template <class Real>
void Reader::real(std::string_view key, Real& value, RealRange range, const char* unit) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (const auto number = real_of<Real>(*visit.node, range))
    value = *number;
  else
    wrong(*visit.node, expected_real(range, unit));
}

void Reader::on_field(std::string_view key, float& value, RealRange range, const char* unit, const char*) {
  real(key, value, range, unit);
}
void Reader::on_field(std::string_view key, double& value, RealRange range, const char* unit, const char*) {
  real(key, value, range, unit);
}

void Reader::on_field(std::string_view key, Vec3& value, RealRange range, const char* unit, const char*) {
  vector(key, value, range, unit, "a list of 3 numbers");
}

void Reader::vector(std::string_view key, Vec3& value, RealRange range, const char* unit, const char* expected) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kSeq || visit.node->items.size() != 3) return wrong(*visit.node, expected);
  for (int axis = 0; axis < 3; ++axis) {
    const Node& item = visit.node->items[std::size_t(axis)];
    if (const auto number = real_of<float>(item, range))
      value[axis] = *number;
    else
      wrong(item, expected_real(range, unit));
  }
}

void Reader::on_field(std::string_view key, GridSize& value, IntRange range, const char* unit, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kSeq || visit.node->items.size() != 2)
    return wrong(*visit.node, "a list of columns and rows");
  GridSize read;
  std::int64_t* sides[] = {&read.columns, &read.rows};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto number = integer_of(visit.node->items[i], range);
    if (!number) return wrong(visit.node->items[i], expected_integer(range, unit));
    *sides[i] = *number;
  }
  value = read;
}

void Reader::on_field(std::string_view key, GraphPoint& value, RealRange range, const char* unit, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kSeq || visit.node->items.size() != 2)
    return wrong(*visit.node, "a list of two numbers, x and y");
  GraphPoint read{.given = true};
  double* axes[] = {&read.x, &read.y};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto number = real_of<double>(visit.node->items[i], range);
    if (!number) return wrong(visit.node->items[i], expected_real(range, unit));
    *axes[i] = *number;
  }
  value = read;
}

void Reader::on_field(std::string_view key, bool& value, const char*, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind == Node::Kind::kBool)
    value = visit.node->text == "true";
  else
    wrong(*visit.node, "true or false");
}

void Reader::on_field(std::string_view key, std::string& value, const char*, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  // A file may well be called 12 or true.
  if (is_scalar(*visit.node) && !visit.node->text.empty())
    value = visit.node->text;
  else
    wrong(*visit.node, "a text that is not empty");
}

void Reader::on_field_or_auto(std::string_view key, std::optional<std::int64_t>& value, IntRange range,
                              const char* unit, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind == Node::Kind::kString && visit.node->text == "auto")
    value.reset();
  else if (const auto number = integer_of(*visit.node, range))
    value = *number;
  else
    wrong(*visit.node, "auto or " + expected_integer(range, unit));
}

bool Reader::is_auto(std::string_view key) const {
  const Node* node = scopes_.back().node->find(key);
  return node && node->kind == Node::Kind::kString && node->text == "auto";
}

void Reader::on_field_or_auto(std::string_view key, std::optional<float>& value, RealRange range, const char* unit,
                              const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (is_auto(key))
    value.reset();
  else if (const auto number = real_of<float>(*visit.node, range))
    value = *number;
  else
    wrong(*visit.node, "auto or " + expected_real(range, unit));
}

void Reader::on_field_or_auto(std::string_view key, std::optional<Vec3>& value, RealRange range, const char* unit,
                              const char*) {
  if (!scopes_.back().node->find(key) || is_auto(key)) {
    const Visit known(*this, key);
    return value.reset();
  }
  vector(key, value.emplace(0.0f), range, unit, "auto or a list of 3 numbers");
}

std::optional<std::size_t> Reader::choose(const Node& node, const std::vector<std::string>& names) {
  if (is_scalar(node))
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == node.text) return i;
  if (names.empty()) {
    wrong(node, "a name that one of engine.plugins brings; they bring none for this key");
    return std::nullopt;
  }
  const auto near = is_scalar(node) ? nearest_name(node.text, names) : std::nullopt;
  wrong(node, "one of " + join(names), near ? fmt::format("; did you mean '{}'?", *near) : "");
  return std::nullopt;
}

void Reader::on_section_or_number(std::string_view key, TesterUnits& value, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind == Node::Kind::kMap) return read(*visit.node, value);
  const IntRange range{1, 1024};
  if (const auto number = integer_of(*visit.node, range))
    value.units = *number;
  else
    wrong(*visit.node, "a map or " + expected_integer(range, "units"));
}

void Reader::require(const Node& node, std::string_view key) {
  if (!key.empty() && node.kind == Node::Kind::kMap && !node.find(key))
    issues_.push_back({node.position, path(), fmt::format("expected the key '{}'", key)});
}

void Reader::texts(std::string_view key, std::vector<std::string>& value, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kSeq) return wrong(*visit.node, "a list");
  value.clear();
  for (const Node& item : visit.node->items) {
    path_.push_back(std::to_string(value.size()));
    if (is_scalar(item) && !item.text.empty())
      value.push_back(item.text);
    else
      wrong(item, "a text that is not empty");
    path_.pop_back();
  }
}

void Reader::effects(std::string_view key, ShadingConfig::Effects& value, const char*) {
  using Choice = ShadingConfig::Effects::Choice;
  const Visit visit(*this, key);
  if (!visit.node) return;
  const Node& node = *visit.node;
  if (node.kind == Node::Kind::kString && (node.text == "auto" || node.text == "all")) {
    value.choice = node.text == "auto" ? Choice::kAuto : Choice::kAll;
  } else if (node.kind == Node::Kind::kSeq) {
    value.choice = Choice::kList;
    value.names.clear();
    for (const Node& item : node.items) {
      if (item.kind == Node::Kind::kString)
        value.names.push_back(item.text);
      else
        wrong(item, "the name of an effect");
    }
  } else {
    wrong(node, "auto, all or a list of effects");
  }
}

void Reader::workload(std::string_view key, WorkloadConfig& value, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  const Node& node = *visit.node;
  const std::string expected =
      "rays, {rays_from: FILE}, {memory_trace: FILE}, {traffic: {...}} or {plugin: NAME, options: {...}}";
  if (node.kind == Node::Kind::kString && node.text == "rays") {
    value.kind = WorkloadConfig::Kind::kRays;
  } else if (node.kind == Node::Kind::kMap) {
    scopes_.push_back({&node, {}});
    field("rays_from", value.rays_from, "", "");
    field("memory_trace", value.memory_trace, "", "");
    section("traffic", value.traffic, "");
    own_workload(value);
    report_unknown(scopes_.back());
    scopes_.pop_back();
    const bool from_file = node.find("rays_from"), traffic = node.find("traffic"), trace = node.find("memory_trace"),
               own = node.find("plugin");
    using enum WorkloadConfig::Kind;
    if (from_file + traffic + trace + own != 1 || (node.find("options") && !own))
      issues_.push_back({node.position, path(), "expected " + expected});
    else
      value.kind = own ? kPlugin : traffic ? kTraffic : trace ? kMemoryTrace : kRaysFrom;
  } else {
    wrong(node, expected);
  }
}

/// The workload of a plugin. An option that is not given has its default.
void Reader::own_workload(WorkloadConfig& value) {
  const WorkloadOffer* offer = nullptr;
  {
    const Visit visit(*this, "plugin");
    const auto chosen = visit.node ? choose<OwnWorkload>(*visit.node) : std::nullopt;
    if (chosen) offer = added_body<WorkloadOffer>(value.own = *chosen);
  }
  const Visit visit(*this, "options");
  if (offer == nullptr) return;  // the options are those of a workload
  for (const WorkloadOption& option : offer->options) value.options[option.name] = option.standard;
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kMap) return wrong(*visit.node, "a map");
  scopes_.push_back({visit.node, {}});
  for (const WorkloadOption& option : offer->options)
    real(option.name, value.options[option.name], {option.least, option.most}, option.unit.c_str());
  report_unknown(scopes_.back());
  scopes_.pop_back();
}

void Reader::vary(std::string_view key, std::map<std::string, std::vector<std::string>>& value, const char*) {
  const Visit visit(*this, key);
  if (!visit.node) return;
  if (visit.node->kind != Node::Kind::kMap) return wrong(*visit.node, "a map of key paths to values");
  for (const Member& member : visit.node->members) {
    path_.push_back(member.key);
    std::vector<std::string>& texts = value[member.key];
    if (is_scalar(member.value))
      texts = {member.value.text};
    else if (member.value.kind != Node::Kind::kSeq || member.value.items.empty())
      wrong(member.value, "a list of values");
    for (const Node& item : member.value.items) {
      if (is_scalar(item))
        texts.push_back(item.text);
      else
        wrong(item, "a value");
    }
    path_.pop_back();
  }
}

/// The map's other members, as numbers.
void Reader::others(std::map<std::string, std::int64_t>& value, IntRange range, const char* unit, const char*) {
  const std::vector<std::string> known = scopes_.back().known;
  for (const Member& member : scopes_.back().node->members) {
    if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
    on_field(member.key, value[member.key], range, unit, "");
  }
}

void Reader::others(std::map<std::string, double>& value, RealRange range, const char* unit, const char*) {
  for (const Member& member : scopes_.back().node->members) real(member.key, value[member.key], range, unit);
}

/// Says why a key of the whole machine is none of one resource, or under which names its numbers stand there. Absent if
/// it is no key at all.
std::optional<std::string> Reader::shared_text(const std::string& key) {
  std::vector<std::string> own, of_section;
  for_each_own_key([&](const auto& row) {
    own.emplace_back(row.name);
    if (std::string_view(row.path).starts_with(key + ".")) of_section.emplace_back(row.name);
  });
  if (!of_section.empty())
    return fmt::format("what a resource has of `{}` stands here without the section; expected {}", key,
                       join(of_section));
  const auto path = config_path_ending_in(key);
  if (!path) return std::nullopt;
  return fmt::format("{} is the same for all resources: {}; expected testers, {}", *path, shared_because(*path),
                     join(own));
}

void Reader::report_unknown(const Scope& frame) {
  for (const Member& member : frame.node->members) {
    if (std::find(frame.known.begin(), frame.known.end(), member.key) != frame.known.end()) continue;
    path_.push_back(member.key);
    std::string message = "unknown key";
    if (const auto shared = frame.own ? shared_text(member.key) : std::nullopt) {
      message = *shared;
    } else if (const auto near = nearest_name(member.key, frame.known)) {
      message += fmt::format("; did you mean '{}'?", *near);
    } else if (const auto elsewhere = config_path_ending_in(member.key)) {
      message += fmt::format("; did you mean '{}'?", *elsewhere);
    } else {
      message += "; " + known_text(member.key, frame.known);
    }
    issues_.push_back({member.key_position, path(), std::move(message)});
    path_.pop_back();
  }
}

}  // namespace carousel::config
