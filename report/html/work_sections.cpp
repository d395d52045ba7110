#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

const Json& schema_at(const Json& schema, const std::string& path) {
  static const Json kNone = Json::object();
  const Json* found = find(schema, path);
  return found ? *found : kNone;
}

int bars_height(const Table& table) {
  return 90 + 30 * static_cast<int>(std::min<std::size_t>(table.rows.size(), 24));
}

}  // namespace

std::string gains_section(const Json& report, const Json& schema) {
  const Json* gains = find(report, "bottleneck.gains");
  const Json* classes = find(report, "bound.classes");
  std::string out;
  if (gains && !gains->empty()) {
    Table table{"gains",
                "Gain of relaxing one class of parts",
                {{"class of parts"}, {"gain"}, {"low"}, {"high"}, {"relaxed together"}, {"change"}, {"to try it"}}};
    for (const Json& gain : *gains) {
      std::string sets;
      for (const Json& set : gain["sets"]) sets += (sets.empty() ? "--set " : " --set ") + set.get<std::string>();
      table.rows.push_back({cell(words(text_at(gain, "name"))), cell(gain["gain"], "fraction"),
                            cell(gain["low"], "fraction"), cell(gain["high"], "fraction"),
                            cell(gain["together"], "classes"), cell(text_at(gain, "action")), cell(sets)});
    }
    out +=
        "<p>The classes of parts were relaxed, alone or with as many others as the table says, and the machine "
        "simulated "
        "again; low and high are the ends of the interval of 95 % of confidence.</p>\n";
    out += Figure{.id = "fig-gains",
                  .kind = "intervals",
                  .tables = table.id,
                  .title = table.caption,
                  .label = "Bars with intervals, greatest gain first: " + table.rows.front()[0].text + " gains " +
                           table.rows.front()[1].text + ".",
                  .height = bars_height(table)}
               .html();
    out += table.html();
  }
  if (classes && !classes->empty()) {
    Table table = table_of("bound", "Rate that each class of parts alone would allow", *classes,
                           schema_at(schema, "properties.bound.properties.classes.items"));
    for (auto& row : table.rows) row[0].text = words(row[0].text);
    out += fmt::format("<p>The run reached {} of the rate of the tightest class.</p>\n",
                       percent(number_at(report, "bound.reached")));
    out += table.html();
  }
  return out;
}

std::string bytes_section(const Json& report, const Json& schema) {
  const Json* bytes = find(report, "bytes");
  if (!bytes || bytes->empty()) return "";
  Json sorted = Json::array();
  for (const Json& row : *bytes)
    if (number_at(row, "bytes") > 0) sorted.push_back(row);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Json& a, const Json& b) { return number_at(a, "bytes") > number_at(b, "bytes"); });
  if (sorted.empty()) return "";
  Table table =
      table_of("bytes-table", "Bytes by kind of message", sorted, schema_at(schema, "properties.bytes.items"));
  const double rays = number_at(report, "rays.completed");
  table.columns.push_back({"bytes a ray"});
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    table.rows[i].push_back(cell(Json(rays > 0 ? number_at(sorted[i], "bytes") / rays : 0.0)));
  return Figure{.id = "fig-bytes",
                .kind = "bars",
                .tables = table.id,
                .title = table.caption,
                .label = "Bars, longest first: " + table.rows.front()[0].text + " are the most bytes.",
                .height = bars_height(table)}
             .html() +
         table.html();
}

std::string latency_section(const Json& report) {
  std::string out;
  for (const auto& [path, title] : {std::pair{"packets.latency", "Latency of packets, from issue to retirement"},
                                    std::pair{"traffic.latency", "Latency of packets of the network"}}) {
    const Json* latency = find(report, path);
    if (!latency) continue;
    Table table{"latency-table", title, {{"packets"}, {"latency not exceeded", "cycles"}}};
    if (const Json* quantiles = find(*latency, "quantiles"))
      for (const Json& q : *quantiles)
        table.rows.push_back({Cell{percent(number_at(q, "part")), q["part"]}, cell(q["cycles"])});
    out += fmt::format("<p>The mean is {:.1f} cycles, the median {}, and 1 of 100 packets took more than {}.</p>\n",
                       number_at(*latency, "mean"), value_text((*latency)["p50"]), value_text((*latency)["p99"]));
    if (!table.rows.empty())
      out += Figure{.id = "fig-latency",
                    .kind = "quantiles",
                    .tables = table.id,
                    .title = title,
                    .label = "Curve of the part of the packets over the latency that they did not exceed."}
                 .html();
    out += table.html();
  }
  return out;
}

std::string collections_section(const Json& report, const Json& schema) {
  const Json* collections = find(report, "collections");
  if (!collections) return "";
  std::string out;
  if (const Json* fullness = find(*collections, "fullness_mean"))
    out += fmt::format("<p>A packet was {} full when it was issued.</p>\n", percent(fullness->get<double>()));
  out += values_of("collections-table", "Collections of all resources", *collections,
                   schema_at(schema, "properties.collections"))
             .html();
  Table each{"collections-each",
             "Collections by resource",
             {{"resource"}, {"made", "collections"}, {"most at one time", "collections"}, {"most waiting", "ray IDs"}}};
  if (const Json* resources = find(report, "resources"))
    for (const Json& r : *resources)
      if (r.contains("collections_created"))
        each.rows.push_back({cell(fmt::format("resource {}", value_text(r["resource"]))),
                             cell(r["collections_created"]), cell(r["collections_peak"]), cell(r["memberships_peak"])});
  if (each.rows.size() > 1)
    out += Figure{.id = "fig-collections",
                  .kind = "bars",
                  .tables = each.id,
                  .title = "Collections made, by resource",
                  .label = "Bars, a bar a resource: collections that it made.",
                  .height = bars_height(each)}
               .html();
  return out + each.html();
}

std::string depth_section(const Json& report, const Json& schema) {
  std::string out;
  if (const Json* depths = find(report, "tests.bundles.by_depth"); depths && !depths->empty()) {
    const Table table = table_of("bundle-depths", "Bundles by depth", *depths,
                                 schema_at(schema, "properties.tests.properties.bundles.properties.by_depth.items"));
    out += Figure{.id = "fig-bundle-depths",
                  .kind = "heat",
                  .tables = table.id,
                  .title = table.caption,
                  .label = "Heat map of the outcomes of bundles, by depth.",
                  .height = 140 + 24 * static_cast<int>(table.columns.size())}
               .html() +
           table.html();
  }
  if (const Json* levels = find(report, "cull_planes.levels"); levels && !levels->empty()) {
    const Table table = table_of("cull-depths", "Cull planes by depth", *levels,
                                 schema_at(schema, "properties.cull_planes.properties.levels.items"));
    out += Figure{.id = "fig-cull-depths",
                  .kind = "heat",
                  .tables = table.id,
                  .title = table.caption,
                  .label = "Heat map of the work that cull planes spare, by depth.",
                  .height = 140 + 24 * static_cast<int>(table.columns.size())}
               .html() +
           table.html();
  }
  return out;
}

std::string rays_section(const Json& report) {
  const Json* rays = find(report, "rays");
  if (!rays || number_at(*rays, "emitted") == 0) return "";
  Table flow{"ray-flow", "Rays by kind and outcome", {{"from"}, {"to"}, {"rays"}}};
  const auto add = [&](const std::string& from, const std::string& to, const Json& count) {
    if (count.is_number() && count.get<double>() > 0) flow.rows.push_back({cell(from), cell(to), cell(count)});
  };
  for (const auto& [kind, count] : (*rays)["by_kind"].items()) add("shading", kind + " rays", count);
  const double completed = number_at(*rays, "completed"), emitted = number_at(*rays, "emitted");
  const bool all = completed == emitted;
  for (const auto& [kind, count] : (*rays)["by_kind"].items())
    add(kind + " rays", all ? "completed" : "completed or lost", count);
  return Figure{.id = "fig-rays",
                .kind = "flow",
                .tables = flow.id,
                .title = flow.caption,
                .label = "Flow of rays from shading by kind to their outcome.",
                .height = 260}
             .html() +
         flow.html();
}

std::string tests_section(const Json& report, const Json& schema) {
  const Json* tests = find(report, "tests");
  if (!tests) return "";
  Table table{
      "tests-table", "Tests and other work for each completed ray", {{"work"}, {"a ray"}, {"in all"}, {"meaning"}}};
  for (const auto& [key, value] : tests->items())
    if (value.is_object() && value.contains("per_ray") && number_at(value, "count") > 0)
      table.rows.push_back({cell(words(key)), cell(value["per_ray"]), cell(value["count"]),
                            cell(text_at(schema, "properties.tests.properties." + key + ".description"))});
  if (table.rows.empty()) return "";
  std::string out = Figure{.id = "fig-tests",
                           .kind = "bars",
                           .tables = table.id,
                           .title = table.caption,
                           .label = "Bars: tests for each completed ray, by kind.",
                           .height = bars_height(table)}
                        .html();
  return out + table.html() +
         "<p>A depth-first tracer of the same rays is not part of this run. <code>--set "
         "topology.shape=independent</code> runs one on the same units.</p>\n";
}

std::string effects_section(const Json& report) {
  const Json* effects = find(report, "shading.effects");
  if (!effects || effects->empty()) return "";
  std::string on;
  Table table{
      "effects-table", "Effects of light", {{"effect"}, {"computed"}, {"callers"}, {"reason"}, {"cycles a hit"}}};
  for (const Json& effect : *effects) {
    const bool is_on = effect.value("on", false);
    if (is_on) on += (on.empty() ? "" : ", ") + words(text_at(effect, "name"));
    table.rows.push_back({cell(words(text_at(effect, "name"))), cell(is_on ? "yes" : "no"), cell(effect["callers"]),
                          cell(text_at(effect, "why")), cell(effect["cost"]["cycles_per_hit"])});
  }
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](const auto& a, const auto& b) { return (a[1].text == "yes") > (b[1].text == "yes"); });
  std::string out = fmt::format("<p>Effects that the scene calls for and that were computed: {}.</p>\n",
                                on.empty() ? "none" : escaped(on));
  if (const Json* saved = find(report, "shading.saved"))
    out += fmt::format("<p>Those that were not computed spare {} bytes of state a path and {} images.</p>\n",
                       value_text((*saved)["path_state_bytes"]), value_text((*saved)["images_not_decoded"]));
  return out + table.html();
}

std::string accuracy_section(const Json& report, const Json& schema) {
  std::string out;
  if (const Json* verify = find(report, "verify")) {
    out += fmt::format("<p>{} rays were traced again, depth first; {} of them differ.</p>\n",
                       value_text((*verify)["compared"]), value_text((*verify)["mismatches"]));
  } else if (find(report, "digest.hits") && number_at(report, "rays.emitted") > 0) {
    out += "<p>This run was not compared with the reference tracer; <code>--set verify=reference</code> does so.</p>\n";
  }
  if (const Json* faults = find(report, "faults"))
    out += values_of("faults-table", "Faults", *faults, schema_at(schema, "properties.faults")).html();
  if (const Json* accuracy = find(report, "config.accuracy"); accuracy && !out.empty()) {
    Table table{"accuracy-table", "Levels of accuracy", {{"arithmetic of"}, {"level"}}};
    for (const auto& [key, level] : accuracy->items())
      if (level.is_primitive()) table.rows.push_back({cell(words(key)), cell(level)});
    out += table.html();
  }
  return out;
}

std::string values_section(const Json& report, const Json& schema) {
  std::string out = "<p>Each value of report.json that is not in a list, with its meaning.</p>\n";
  for (const auto& [key, value] : report.items()) {
    if (key == "config" || !value.is_object()) continue;
    const Table table = values_of("values-" + key, key, value, schema_at(schema, "properties." + key));
    if (table.rows.empty()) continue;
    const std::string html = table.html();
    const bool folded = html.starts_with("<details");
    out += folded ? html
                  : fmt::format("<details><summary>Table: {} ({} rows)</summary>\n{}</details>\n", key,
                                table.rows.size(), html);
  }
  return out;
}

}  // namespace carousel::report::html
