#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/run/report_json.h"

namespace carousel::report::html {

namespace {

/// The uses of time of all parts, in the order of the chart. Cycles in which a part of a kind's units works are divided
/// by that part.
struct Use {
  const char* key;
  const char* title;
};
constexpr Use kUses[] = {{"busy", "working"},
                         {"unfilled", "places left empty"},
                         {"other_units", "other units work"},
                         {"latency", "waits for its pipelines"},
                         {"passing", "no test under way"},
                         {"memory", "waits for memory"},
                         {"link", "waits for a link"},
                         {"credits", "waits for credits"},
                         {"storage", "waits for storage"},
                         {"shading", "helps shading"},
                         {"idle", "nothing to do"}};
constexpr std::size_t kUseCount = std::size(kUses);
using Shares = std::array<double, kUseCount>;

Table table_of_uses(const char* id, const char* caption, const char* first) {
  Table table{id, caption, {{first}}};
  for (const Use& use : kUses) table.columns.push_back({use.title, "", "share of the cycles"});
  return table;
}

void add(Table& table, const std::string& name, const Shares& shares) {
  auto& row = table.rows.emplace_back();
  row.push_back(cell(name));
  for (const double s : shares) row.push_back(share(s));
}

/// The cycles of a kind of unit of a resource.
Shares shares_of(const Json& units, const std::string& kind, double cycles) {
  const Json& unit = units[kind];
  const double fill = std::clamp(number_at(units, "unit_fill." + kind, 1), 0.0, 1.0);
  Shares out{};
  for (std::size_t u = 0; u < kUseCount; ++u) out[u] = number_at(unit, kUses[u].key) / cycles;
  const double busy = out[0];
  out[0] = fill * busy;
  out[1] = busy - out[0];
  return out;
}

Shares busy_and_idle(double busy, double waits = 0) {
  Shares out{};
  const auto set = [&](std::string_view key, double value) {
    for (std::size_t u = 0; u < kUseCount; ++u)
      if (key == kUses[u].key) out[u] = value;
  };
  set("busy", busy);
  set("link", waits);
  set("idle", std::max(0.0, 1 - busy - waits));
  return out;
}

/// The sums over the resources, a row a kind of unit that did anything. `testing`: how many have units.
void add_units(Table& table, const Json& resources, std::size_t testing, double cycles) {
  std::vector<std::pair<std::string, Shares>> kinds;
  double dispatch = 0;
  for (std::size_t i = 0; i < resources.size(); ++i) {
    const Json& resource = resources[i];
    for (const auto& [kind, unit] : resource["units"].items()) {
      if (i >= testing || !unit.is_object() || !unit.contains("busy")) continue;
      const Shares one = shares_of(resource["units"], kind, cycles * static_cast<double>(testing));
      auto found = std::find_if(kinds.begin(), kinds.end(), [&k = kind](const auto& row) { return row.first == k; });
      if (found == kinds.end()) found = kinds.insert(kinds.end(), {kind, Shares{}});
      for (std::size_t u = 0; u < kUseCount; ++u) found->second[u] += one[u];
    }
    dispatch += number_at(resource, "units.dispatch_busy") / (cycles * static_cast<double>(resources.size()));
  }
  for (const auto& [kind, shares] : kinds)
    if (shares[0] > 0) add(table, words(kind) + (kind == "ray_reads" ? "" : " units"), shares);
  if (dispatch > 0) add(table, "dispatch", busy_and_idle(dispatch));
}

Table parts_table(const Json& report) {
  const double cycles = number_at(report, "engine.cycles");
  const Json* resources = find(report, "resources");
  Table parts = table_of_uses("cycles-by-part", "Use of the cycles by kind of part", "part");
  if (cycles <= 0) return parts;
  if (resources && !resources->empty() && resources->front().contains("units"))
    add_units(parts, *resources, resources_with_units(report.value("config", Json::object()), resources->size()),
              cycles);
  if (const Json* links = find(report, "links"); links && !links->empty() && links->front().contains("cycles")) {
    double busy = 0, stalled = 0;
    for (const Json& link : *links) {
      busy += number_at(link, "cycles.busy");
      stalled += number_at(link, "cycles.stalled");
    }
    const double all = cycles * static_cast<double>(links->size());
    add(parts, "links", busy_and_idle(busy / all, stalled / all));
  }
  if (const Json* caches = find(report, "memory.caches"); caches && !caches->empty()) {
    double port = 0;
    for (const Json& cache : *caches) port += number_at(cache, "port_utilisation");
    add(parts, "ports of the L2", busy_and_idle(port / static_cast<double>(caches->size())));
  }
  if (find(report, "memory")) add(parts, "DRAM", busy_and_idle(number_at(report, "memory.dram_utilisation")));
  if (find(report, "shading.utilisation"))
    add(parts, "shader workers", busy_and_idle(number_at(report, "shading.utilisation")));
  return parts;
}

}  // namespace

std::string use_words(std::string_view key) {
  for (const Use& use : kUses)
    if (key == use.key) return use.title;
  return {};
}

Html still_cycles(const Json& report) {
  const Table parts = parts_table(report);
  return parts.rows.empty() ? Html() : still_stack(parts);
}

Html cycles_section(const Json& report) {
  const double cycles = number_at(report, "engine.cycles");
  const Json* resources = find(report, "resources");
  if (cycles <= 0) return {};
  const Table parts = parts_table(report);
  Table each = table_of_uses("cycles-by-resource", "Use of the cycles of the box units, by resource", "resource");
  if (resources && !resources->empty() && resources->front().contains("units"))
    for (std::size_t i = 0, n = resources_with_units(report.value("config", Json::object()), resources->size()); i < n;
         ++i)
      if (const Json& r = (*resources)[i]; find(r, "units.box"))
        add(each, fmt::format("resource {}", value_text(r["resource"])), shares_of(r["units"], "box", cycles));
  if (parts.rows.empty()) return {};
  Html out = markup(
      "<p>Each line adds up to all cycles of the run. A unit that waits shows the part that kept it. Where a "
      "part of a kind's units works, the empty places of the others stand beside it.</p>\n");
  const auto height = [](const Table& t) {
    return 110 + 30 * static_cast<int>(std::min<std::size_t>(t.rows.size(), 32));
  };
  out += Figure{.id = "fig-cycles",
                .kind = "stacked",
                .tables = parts.id,
                .title = parts.caption,
                .label = "Stacked bars, a bar a kind of part: the shares of its cycles, which add up to 100 percent.",
                .height = height(parts),
                .still = still_stack(parts)}
             .html();
  out += parts.html();
  if (each.rows.size() > 1) {
    out += Figure{.id = "fig-cycles-each",
                  .kind = "stacked",
                  .tables = each.id,
                  .title = each.caption,
                  .label = "Stacked bars, a bar a resource: the shares of the cycles of its box units.",
                  .height = height(each),
                  .still = still_stack(each)}
               .html();
    out += each.html();
  }
  return out;
}

namespace {

struct Wait {
  std::string keeper, waiting;
  double amount = 0, share = 0;
};

void add_waits(std::vector<Wait>& out, const Json& report, double cycles) {
  struct Reason {
    const char *key, *keeper;
  };
  constexpr Reason kReasons[] = {
      {"memory", "memory (shape data on its way)"},    {"link", "the link that it sends on (full)"},
      {"credits", "its own packets (all under way)"},  {"storage", "its collections (no free block)"},
      {"shading", "shader workers (helped out)"},      {"slots", "ray slots (all taken)"},
      {"reserve", "its collections (reserve entered)"}};
  if (const Json* resources = find(report, "resources")) {
    for (const Json& r : *resources) {
      const Json* from = find(r, "units.box");
      if (!from) from = find(r, "stalls");
      if (!from) continue;
      for (const Reason& reason : kReasons)
        if (const double amount = number_at(*from, reason.key); amount > 0)
          out.push_back({reason.keeper, fmt::format("resource {}", value_text(r["resource"])), amount,
                         cycles > 0 ? amount / cycles : 0});
    }
  }
  if (const Json* links = find(report, "links")) {
    const auto nodes = static_cast<std::uint64_t>(number_at(report, "config.topology.resources"));
    const auto name = [&](const Json& node) {
      const auto n = node.get<std::uint64_t>();
      return n < nodes ? fmt::format("resource {}", n) : fmt::format("hub {}", n - nodes);
    };
    for (const Json& link : *links)
      if (const double amount = number_at(link, "stalled"); amount > 0)
        out.push_back({name(link["to"]) + " (its queue is full)",
                       fmt::format("link from {} to {}", name(link["from"]), name(link["to"])), amount,
                       cycles > 0 ? amount / cycles : 0});
  }
  std::stable_sort(out.begin(), out.end(), [](const Wait& a, const Wait& b) { return a.amount > b.amount; });
}

}  // namespace

Html waits_section(const Json& report) {
  const double cycles = number_at(report, "engine.cycles");
  std::vector<Wait> waits;
  add_waits(waits, report, cycles);
  if (waits.empty()) return {};
  constexpr std::size_t kMost = 40;
  const bool timed = cycles > 0;
  std::map<std::string, double> keepers;
  for (const Wait& wait : waits)
    keepers[wait.waiting.starts_with("link") ? "queues at the ends of links" : wait.keeper] += wait.amount;
  std::vector<std::pair<std::string, double>> ranked(keepers.begin(), keepers.end());
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  const std::string unit = timed ? "cycles" : "attempts";
  Table sums{"waits", "Causes of waiting, over all parts", {{"kept waiting by"}, {"waiting", unit}}};
  for (const auto& [keeper, amount] : ranked)
    sums.rows.push_back({cell(keeper), cell(Json(static_cast<std::uint64_t>(amount)))});
  Table each{"waits-each", "Single parts that waited longest", {{"part"}, {"kept waiting by"}, {"waited", unit}}};
  if (timed) each.columns.push_back({"of all cycles"});
  for (std::size_t i = 0; i < std::min(waits.size(), kMost); ++i) {
    const Wait& wait = waits[i];
    each.rows.push_back({cell(wait.waiting), cell(wait.keeper), cell(Json(static_cast<std::uint64_t>(wait.amount)))});
    if (timed) each.rows.back().push_back(share(wait.share));
  }
  Html out = timed ? markup("<p>Cycles in which a part had work and could not go on.</p>\n")
                   : markup(
                         "<p>Attempts of worker threads that could not go on. They are counts of this host, not times "
                         "of the simulated machine.</p>\n");
  out += Figure{.id = "fig-waits",
                .kind = "bars",
                .tables = sums.id,
                .title = sums.caption,
                .label = fmt::format("Bars, longest first: {} is the greatest cause of waiting.", ranked.front().first),
                .height = 90 + 34 * static_cast<int>(sums.rows.size()),
                .still = still_bars(sums, 1)}
             .html();
  return out + sums.html() + each.html();
}

}  // namespace carousel::report::html
