#include "report/read/consistency.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/read/strict_json.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

const Json& list_at(const Json& json, const char* key) {
  static const Json kNone = Json::array();
  const auto found = json.find(key);
  return found == json.end() ? kNone : *found;
}

constexpr std::size_t kMostHubs = 1 << 16;

/// The number at a key is a place in a list of so many.
void require_place(const Json& item, const std::string& path, const char* key, std::size_t size) {
  const auto number = item.at(key).get<std::uint64_t>();
  if (number >= size)
    throw JsonFault(path_below(path, key), fmt::format("expected a number below {}, found {}", size, number));
}

/// All items of a list have a key, or none has.
void require_in_all(const Json& report, const char* list, const char* key) {
  const Json& items = list_at(report, list);
  for (std::size_t i = 1; i < items.size(); ++i)
    if (items[i].contains(key) != items[0].contains(key))
      throw JsonFault(path_below(path_below(list, i), key),
                      fmt::format("expected in all of {} or in none, found in some", list));
}

void require_series(const Json& report) {
  const auto series = report.find("time_series");
  if (series == report.end()) return;
  const auto samples = (*series)["samples"].get<std::uint64_t>();
  const Json& rows = (*series)["rows"];
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i]["values"].size() != samples)
      throw JsonFault(
          path_below(path_below("time_series.rows", i), "values"),
          fmt::format("expected {} values, as time_series.samples says, found {}", samples, rows[i]["values"].size()));
}

void require_ranks(const Json& report) {
  const Json &ranks = list_at(report, "ranks"), &links = list_at(report, "rank_links");
  if (report.contains("ranks") != report.contains("rank_links") || ranks.empty() != links.empty())
    throw JsonFault("rank_links", "expected with ranks, and not without");
  if (report.contains("ranks") && ranks.empty()) throw JsonFault("ranks", "expected at least one");
  for (std::size_t i = 0; i < ranks.size(); ++i) require_place(ranks[i], path_below("ranks", i), "rank", ranks.size());
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const char* end : {"from", "to"}) require_place(links[i], path_below("rank_links", i), end, ranks.size());
}

void require_machine(const Json& report) {
  const Json &resources = list_at(report, "resources"), &links = list_at(report, "links");
  for (std::size_t i = 0; i < resources.size(); ++i)
    require_place(resources[i], path_below("resources", i), "resource", resources.size());
  const Json::json_pointer configured("/config/topology/resources");
  const auto count = report.contains(configured) && report[configured].is_number_unsigned()
                         ? report[configured].get<std::uint64_t>()
                         : resources.size();
  if (!resources.empty() && count != resources.size())
    throw JsonFault("resources",
                    fmt::format("expected {}, as config.topology.resources says, found {}", count, resources.size()));
  // Behind the resources come the hubs.
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const char* end : {"from", "to"}) require_place(links[i], path_below("links", i), end, count + kMostHubs);
}

std::vector<std::string> names_of(const Json& sweep, const char* key) {
  std::vector<std::string> names = sweep.at(key).get<std::vector<std::string>>();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      throw JsonFault(path_below(key, i), "the name stands twice");
  return names;
}

void require_one_of(const std::vector<std::string>& names, const std::string& name, const std::string& path,
                    const char* of) {
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw JsonFault(path, fmt::format("expected one of {}, found {}", of, found_text(name)));
}

}  // namespace

void require_consistent_run(const Json& report) {
  require_series(report);
  require_ranks(report);
  require_machine(report);
  require_in_all(report, "resources", "units");
  require_in_all(report, "links", "utilisation");
  require_in_all(report, "links", "cycles");
}

void require_consistent_sweep(const Json& sweep) {
  const std::vector<std::string> keys = names_of(sweep, "keys"), results = names_of(sweep, "results");
  const Json& points = sweep["points"];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string path = path_below("points", i);
    for (const auto& [key, value] : points[i]["keys"].items())
      require_one_of(keys, key, path_below(path_below(path, "keys"), key), "keys");
    for (const auto& [key, value] : points[i]["results"].items())
      require_one_of(results, key, path_below(path_below(path, "results"), key), "results");
  }
  const Json& effects = sweep["main_effects"];
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const std::string path = path_below("main_effects", i);
    require_one_of(keys, effects[i]["key"], path_below(path, "key"), "keys");
    require_one_of(results, effects[i]["result"], path_below(path, "result"), "results");
  }
}

}  // namespace carousel::report
