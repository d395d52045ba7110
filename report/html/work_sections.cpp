#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

/// A distribution of report.json as a table and bars; nothing if it is absent or empty. `counted` names its values.
Html distribution(const Json& report, const std::string& path, const std::string& id, const std::string& title,
                  const std::string& counted) {
  const Json* found = find(report, path);
  if (!found || number_at(*found, "count") == 0) return {};
  Table table{id, title, {{"cycles"}, {counted}, {"share"}}};
  for (const Json& row : (*found)["classes"])
    table.rows.push_back({cell(row["from"] == row["to"] ? value_text(row["from"])
                                                        : value_text(row["from"]) + " to " + value_text(row["to"])),
                          cell(row["count"]), share(number_at(row, "count") / number_at(*found, "count"))});
  return markup("<p>{}: the mean is {} cycles, the greatest {}.</p>\n", title,
                value_text(Json(number_at(*found, "mean"))), value_text((*found)["max"])) +
         Figure{.id = "fig-" + id,
                .kind = "histogram",
                .tables = id,
                .title = title,
                .label = "Bars: " + counted + " in classes of time that double.",
                .height = 300}
             .html() +
         table.html();
}

}  // namespace

Html gains_section(const Json& report, const Json& schema) {
  const Json* gains = find(report, "bottleneck.gains");
  const Json* classes = find(report, "bound.classes");
  Html out;
  if (gains && !gains->empty()) {
    Table table{"gains",
                "Gain of relaxing one class of parts",
                {{"class of parts"},
                 {"gain"},
                 {"low"},
                 {"high"},
                 {"relaxed together"},
                 {"of the frame"},
                 {"change"},
                 {"to try it"}}};
    for (const Json& gain : *gains) {
      const Json* frame = find(gain, "frame");  // absent in older reports
      std::string sets;
      for (const Json& set : gain["sets"]) sets += (sets.empty() ? "--set " : " --set ") + set.get<std::string>();
      table.rows.push_back({cell(words(text_at(gain, "name"))), cell(gain["gain"], "fraction"),
                            cell(gain["low"], "fraction"), cell(gain["high"], "fraction"),
                            cell(gain["together"], "classes"), frame ? cell(*frame, "fraction") : cell(""),
                            cell(text_at(gain, "action")), cell(sets)});
    }
    out += markup(
        "<p>The classes of parts were relaxed, alone or with as many others as the table says. The machine simulated a "
        "pilot again, or as much of the frame from its start as the table says. Low and high are the ends of the "
        "interval of 95 % of confidence.</p>\n");
    out += Figure{.id = "fig-gains",
                  .kind = "intervals",
                  .tables = table.id,
                  .title = table.caption,
                  .label = "Bars with intervals, greatest gain first: " + table.rows.front()[0].text + " gains " +
                           table.rows.front()[1].text + ".",
                  .height = bars_height(table),
                  .still = still_gains(still_gains_of(report))}
               .html();
    out += table.html();
  }
  if (classes && !classes->empty()) {
    Table table = table_of("bound", "Rate that each class of parts alone would allow", *classes,
                           schema_at(schema, "properties.bound.properties.classes.items"));
    for (auto& row : table.rows) row[0].text = words(row[0].text);
    out += markup("<p>The run reached {} of the rate of the tightest class.</p>\n",
                  percent(number_at(report, "bound.reached")));
    out += table.html();
  }
  return out;
}

namespace {

std::size_t bytes_column(const Table& table) {
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    if (table.columns[c].title == "bytes") return c;
  return 1;
}

}  // namespace

Html bytes_section(const Json& report, const Json& schema) {
  const Json* bytes = find(report, "bytes");
  if (!bytes || bytes->empty()) return {};
  Json sorted = Json::array();
  for (const Json& row : *bytes)
    if (number_at(row, "bytes") > 0) sorted.push_back(row);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Json& a, const Json& b) { return number_at(a, "bytes") > number_at(b, "bytes"); });
  if (sorted.empty()) return {};
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
                .height = bars_height(table),
                .still = still_bars(table, bytes_column(table))}
             .html() +
         table.html();
}

Html latency_section(const Json& report) {
  Html out;
  for (const auto& [path, title] : {std::pair{"packets.latency", "Latency of packets, from issue to retirement"},
                                    std::pair{"traffic.latency", "Latency of packets of the network"}}) {
    const Json* latency = find(report, path);
    if (!latency) continue;
    Table table{"latency-table", title, {{"packets"}, {"latency not exceeded", "cycles"}}};
    if (const Json* quantiles = find(*latency, "quantiles"))
      for (const Json& q : *quantiles)
        table.rows.push_back({Cell{percent(number_at(q, "part")), q["part"]}, cell(q["cycles"])});
    out += markup("<p>The mean is {:.1f} cycles, the median {}, and 1 of 100 packets took more than {}.</p>\n",
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
  return out + distribution(report, "rays.residence", "residence",
                            "Residence of rays, from their slot until their hit is at shading", "rays");
}

Html collections_section(const Json& report, const Json& schema) {
  const Json* collections = find(report, "collections");
  if (!collections || number_at(*collections, "created", 1) == 0) return {};
  Html out;
  if (const Json* fullness = find(*collections, "fullness_mean"))
    out += markup("<p>A packet was {} full when it was issued.</p>\n", percent(fullness->get<double>()));
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
  return out + each.html() +
         distribution(report, "collections.age", "collection-ages",
                      "Age of collections when a packet was taken from them", "packets");
}

Html effects_section(const Json& report) {
  const Json* effects = find(report, "shading.effects");
  if (!effects || effects->empty()) return {};
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
  Html out = markup("<p>Effects that the scene calls for and that were computed: {}.</p>\n", on.empty() ? "none" : on);
  if (const Json* saved = find(report, "shading.saved"))
    out += markup("<p>Those that were not computed spare {} bytes of state a path and {} images.</p>\n",
                  value_text((*saved)["path_state_bytes"]), value_text((*saved)["images_not_decoded"]));
  if (const Json* spared = find(report, "effects.spared"))
    out +=
        markup("<p>By forecast, all effects at every surface would cost {} cycles ({} to {}): {} are spared.{}</p>\n",
               value_text((*spared)["cycles_with_all"]), value_text((*spared)["low"]), value_text((*spared)["high"]),
               percent(number_at(*spared, "fraction")),
               spared->contains("measured")
                   ? fmt::format(" A run with all of them took {}.", value_text((*spared)["measured"]))
                   : std::string());
  return out + table.html();
}

Html accuracy_section(const Json& report, const Json& schema) {
  Html out;
  if (const Json* verify = find(report, "verify")) {
    out += markup("<p>{} rays were traced again, depth first; {} of them differ.</p>\n",
                  value_text((*verify)["compared"]), value_text((*verify)["mismatches"]));
  } else if (find(report, "digest.hits") && number_at(report, "rays.emitted") > 0) {
    out += markup(
        "<p>This run was not compared with the reference tracer; <code>--set verify=reference</code> does so.</p>\n");
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

Html values_section(const Json& report, const Json& schema) {
  Html out = markup("<p>Each value of report.json that is not in a list, with its meaning.</p>\n");
  for (const auto& [key, value] : report.items()) {
    if (key == "config" || !value.is_object()) continue;
    const Table table = values_of("values-" + key, key, value, schema_at(schema, "properties." + key));
    if (table.rows.empty()) continue;
    out += table.html();
  }
  return out;
}

}  // namespace carousel::report::html
