#include "report/compare/comparison.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "core/numeric/noise_between.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;
using Values = std::vector<std::optional<double>>;

std::optional<double> number_at(const Json& report, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!report.contains(at) || !report.at(at).is_number()) return std::nullopt;
  return report.at(at).get<double>();
}

std::string text_at(const Json& report, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!report.contains(at)) return "";
  return report.at(at).is_string() ? report.at(at).get<std::string>() : report.at(at).dump();
}

ComparedRow row_of(std::string name, std::string unit, Values values) {
  ComparedRow out{std::move(name), std::move(unit), std::move(values), {}};
  const std::optional<double> first = out.values.front();
  for (const std::optional<double>& value : out.values)
    out.ratios.push_back(value && first && *first != 0 ? std::optional(*value / *first) : std::nullopt);
  return out;
}

struct NumberRow {
  const char *name, *pointer, *unit;
  bool of_cycles = false;
};

constexpr NumberRow kThroughput[] = {
    {"whole run", "/throughput/whole/rays_per_kilocycle", "rays/kilocycle", true},
    {"steady state", "/throughput/steady/rays_per_kilocycle", "rays/kilocycle"},
    {"whole run, at its clock", "/throughput/whole/mrays_per_second_at_clock", "Mrays/s", true},
    {"on this host", "/host/rays_per_second", "rays/s"},
    {"length", "/engine/cycles", "cycles", true},
    {"rays", "/rays/completed", "rays"},
    {"tests", "/throughput/tests_per_ray", "tests/ray"},
    {"packets", "/throughput/packets_per_ray", "packets/ray"},
    {"hops", "/throughput/hops_per_ray", "hops/ray"},
    {"rays of a packet", "/packets/rays_mean", "rays"},
    {"latency of a packet, median", "/packets/latency/p50", "cycles or ns"},
    {"latency of a packet, 99 %", "/packets/latency/p99", "cycles or ns"},
    {"share of the bound", "/bound/reached", "share"},
};
constexpr NumberRow kMemory[] = {
    {"shape buffers hit", "/memory/shape_buffers/hit_fraction", "share"},
    {"L2 hit", "/memory/caches/0/hit_fraction", "share"},
    {"DRAM busy", "/memory/dram_utilisation", "share"},
    {"DRAM read", "/memory/dram_bytes", "bytes"},
    {"collections at once", "/collections/peak", "collections"},
    {"ray IDs at once", "/collections/ids_at_once", "ray IDs"},
    {"path state", "/shading/path_state_bytes", "bytes"},
};

template <std::size_t N>
ComparedSection numbers(const char* name, const NumberRow (&rows)[N], const std::vector<ComparedRun>& runs) {
  ComparedSection out{name, {}};
  for (const NumberRow& row : rows) {
    Values values;
    for (const ComparedRun& run : runs) values.push_back(number_at(run.report, row.pointer));
    out.rows.push_back(row_of(row.name, row.unit, std::move(values)));
    out.rows.back().of_cycles = row.of_cycles;
  }
  return out;
}

/// As Comparison::within_noise.
std::optional<double> noise_that_holds(const Json& first, const Json& run) {
  const auto a = number_at(first, "/engine/cycles"), b = number_at(run, "/engine/cycles");
  const auto noise = noise_between(number_at(first, "/cycle_noise/fraction"), number_at(run, "/cycle_noise/fraction"));
  if (!a || !b || *a == 0 || !noise) return std::nullopt;
  return std::abs(*b / *a - 1) <= *noise ? noise : std::nullopt;
}

/// A section whose rows follow from the report: each run gives its own, and the section has all of them.
ComparedSection gathered(const char* name, const char* unit, const std::vector<ComparedRun>& runs,
                         const std::function<std::vector<std::pair<std::string, double>>(const Json&)>& rows_of) {
  std::vector<std::string> order;
  std::map<std::string, Values> values;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (const auto& [row, value] : rows_of(runs[r].report)) {
      const auto [entry, fresh] = values.try_emplace(row, runs.size());
      if (fresh) order.push_back(row);
      entry->second[r] = value;
    }
  }
  ComparedSection out{name, {}};
  for (const std::string& row : order) out.rows.push_back(row_of(row, unit, values[row]));
  return out;
}

using Pairs = std::vector<std::pair<std::string, double>>;

/// Where the cycles of the test units of all resources went, as shares of the cycles of a kind of unit.
Pairs cycle_ledger(const Json& report) {
  Pairs out;
  std::map<std::string, std::size_t> at;
  std::map<std::string, double> whole;
  for (const Json& resource : report.value("resources", Json::array())) {
    if (!resource.contains("units")) continue;
    for (const auto& [unit, causes] : resource["units"].items()) {
      if (!causes.is_object() || !causes.contains("busy")) continue;
      for (const auto& [cause, cycles] : causes.items()) {
        const auto [entry, fresh] = at.try_emplace(unit + " " + cause, out.size());
        if (fresh) out.emplace_back(entry->first, 0);
        out[entry->second].second += cycles.get<double>();
        whole[unit] += cycles.get<double>();
      }
    }
  }
  for (auto& [row, cycles] : out) {
    const double all = whole[row.substr(0, row.find(' '))];
    cycles = all > 0 ? cycles / all : 0;
  }
  return out;
}

Pairs byte_ledger(const Json& report) {
  Pairs out;
  const double rays = report.contains("rays") ? report["rays"].value("completed", 0.0) : 0;
  for (const Json& row : report.value("bytes", Json::array()))
    out.emplace_back(fmt::format("{}, {} to {}", row.value("what", ""), row.value("from", ""), row.value("to", "")),
                     row.value("bytes", 0.0) / std::max(1.0, rays));
  return out;
}

/// All numbers of a section of the report, by their path below it.
Pairs leaves(const Json& report, const char* section) {
  Pairs out;
  const std::function<void(const Json&, const std::string&)> walk = [&](const Json& value, const std::string& path) {
    if (value.is_number()) out.emplace_back(path, value.get<double>());
    if (value.is_structured())
      for (const auto& [key, child] : value.items()) walk(child, path.empty() ? key : path + "." + key);
  };
  if (report.contains(section)) walk(report[section], "");
  return out;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// True if the parts of the pattern between its stars come in the text in their order.
bool matches(std::string_view text, const std::string& pattern) {
  const std::string where = lower(text), wanted = lower(pattern);
  std::size_t from = 0;
  for (std::size_t begin = 0; begin <= wanted.size();) {
    const std::size_t star = std::min(wanted.find('*', begin), wanted.size());
    const std::size_t found = where.find(wanted.substr(begin, star - begin), from);
    if (found == where.npos) return false;
    from = found + (star - begin);
    begin = star + 1;
  }
  return true;
}

bool is_empty(const ComparedRow& row) {
  return std::none_of(row.values.begin(), row.values.end(), [](const auto& value) { return value && *value != 0; });
}

}  // namespace

Comparison compare_runs(const std::vector<ComparedRun>& runs, const std::string& only) {
  Comparison out;
  std::vector<const Json*> reports;
  for (const ComparedRun& run : runs) {
    const bool is_first = &run == runs.data();
    out.within_noise.push_back(is_first ? std::nullopt : noise_that_holds(runs.front().report, run.report));
    const Json& first = runs.front().report;
    out.runs.push_back(run.name);
    out.same_hits.push_back(text_at(run.report, "/digest/hits") == text_at(first, "/digest/hits"));
    out.same_picture.push_back(text_at(run.report, "/digest/image") == text_at(first, "/digest/image"));
    out.deterministic = out.deterministic && text_at(run.report, "/engine/deterministic") != "false";
    reports.push_back(&run.report);
  }
  constexpr std::string_view kConfig = "config.";
  for (ManyDifference& difference : differences(reports)) {
    const bool key = difference.path.starts_with(kConfig);
    (key ? out.configuration : out.differences)
        .push_back({key ? difference.path.substr(kConfig.size()) : difference.path, std::move(difference.values)});
  }
  out.same_configuration = out.configuration.empty();
  out.identical = out.same_configuration && out.differences.empty();

  ComparedText verdict{"verdict", {}};
  for (const ComparedRun& run : runs) verdict.texts.push_back(text_at(run.report, "/bottleneck/verdict"));
  out.texts.push_back(std::move(verdict));
  out.sections.push_back(numbers("throughput", kThroughput, runs));
  out.sections.push_back(gathered("cycles of the test units", "share", runs, cycle_ledger));
  out.sections.push_back(gathered("bytes", "bytes/ray", runs, byte_ledger));
  out.sections.push_back(numbers("memory", kMemory, runs));
  for (const char* section : {"area", "energy"})
    out.sections.push_back(
        gathered(section, "", runs, [section](const Json& report) { return leaves(report, section); }));

  const auto drop = [](auto& list, const auto& unwanted) {
    list.erase(std::remove_if(list.begin(), list.end(), unwanted), list.end());
  };
  const auto other = [&](const ComparedText& text) { return !matches(text.name, only); };
  drop(out.texts, [&](const ComparedText& text) {
    return other(text) || std::all_of(text.texts.begin(), text.texts.end(), [](const auto& t) { return t.empty(); });
  });
  const std::size_t keys = out.configuration.size(), values = out.differences.size();
  drop(out.configuration, other);
  drop(out.differences, other);
  out.keys_hidden = keys - out.configuration.size();
  out.values_hidden = values - out.differences.size();
  for (ComparedSection& section : out.sections)
    drop(section.rows, [&](const ComparedRow& row) {
      return is_empty(row) || !(matches(section.name, only) || matches(row.name, only));
    });
  drop(out.sections, [](const ComparedSection& section) { return section.rows.empty(); });
  return out;
}

nlohmann::ordered_json comparison_json(const Comparison& c, bool all) {
  const auto texts = [](const std::vector<ComparedText>& list) {
    Json out = Json::array();
    for (const ComparedText& text : list) out.push_back({{"name", text.name}, {"values", text.texts}});
    return out;
  };
  const auto values = [](const Values& list) {
    Json out = Json::array();
    for (const std::optional<double>& value : list) out.push_back(value ? Json(*value) : Json());
    return out;
  };
  Json sections = Json::array();
  for (const ComparedSection& section : c.sections) {
    Json rows = Json::array();
    for (const ComparedRow& row : section.rows)
      rows.push_back(
          {{"name", row.name}, {"unit", row.unit}, {"values", values(row.values)}, {"ratios", values(row.ratios)}});
    sections.push_back({{"name", section.name}, {"rows", std::move(rows)}});
  }
  Json out{{"runs", c.runs},
           {"identical", c.identical},
           {"same_hits", c.same_hits},
           {"same_picture", c.same_picture},
           {"within_noise", values(c.within_noise)},
           {"same_configuration", c.same_configuration},
           {"deterministic", c.deterministic},
           {"texts", texts(c.texts)},
           {"sections", std::move(sections)},
           {"configuration", texts(c.configuration)},
           {"keys_hidden", c.keys_hidden},
           {"values_that_differ", c.differences.size()},
           {"values_hidden", c.values_hidden}};
  if (all) out["differences"] = texts(c.differences);
  return out;
}

}  // namespace carousel::report
