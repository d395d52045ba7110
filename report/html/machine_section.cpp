#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"

namespace carousel::report::html {

namespace {

/// The row of a list in which a number is greatest.
const Json& greatest(const Json& rows, const char* key) {
  return *std::max_element(rows.begin(), rows.end(),
                           [&](const Json& a, const Json& b) { return number_at(a, key) < number_at(b, key); });
}

/// The rank and the way between ranks to look at first.
Html rank_words(const Json& report) {
  const Json &rank = greatest(report.at("ranks"), "waiting"), &held = greatest(report.at("rank_links"), "held"),
             &full = greatest(report.at("rank_links"), "full");
  Html out = markup("<p>Of the ranks, {} waited most, for {} of its threads' time. ", rank.at("rank").dump(),
                    share(number_at(rank, "waiting")).text);
  out += markup("Messages from rank {} to {} waited most for earlier ones to leave, for {} of the run. ",
                held.at("from").dump(), held.at("to").dump(), share(number_at(held, "held")).text);
  if (number_at(full, "full") > 0)
    out += markup("Back-pressure was greatest from rank {} to {}, where links were full {} times.",
                  full.at("from").dump(), full.at("to").dump(), value_text(full.at("full")));
  return out + markup("</p>\n");
}

/// Without the columns that only some runs have, where they are zero; and without nanoseconds of which the share is
/// there.
Html rank_table(const char* key, const char* title, const Json& report, const Json& schema) {
  const Json& rows = report.at(key);
  std::vector<std::string> left_out{"hold_ns"};
  for (const char* rare : {"guest_bytes", "heartbeats", "shapes", "shape_bytes"})
    if (number_at(greatest(rows, rare), rare) == 0) left_out.emplace_back(rare);
  return table_of(key, title, rows, *find(schema, fmt::format("properties.{}.items", key)), left_out).html();
}

/// An end of a link, in words.
std::string end_words(const Json& report, double end) {
  const auto at = static_cast<std::size_t>(end);
  if (const Json* nodes = find(report, "drawing"); nodes && at < nodes->size()) return text_at((*nodes)[at], "name");
  const double resources = number_at(report, "config.topology.resources");
  if (end < resources) return fmt::format("resource {}", at);
  if (text_at(report, "config.topology.shape") == "bus") return "the bus";
  return fmt::format("bridge {}", at - static_cast<std::size_t>(resources));
}

}  // namespace

BusiestLink busiest_link(const Json& report) {
  const Json* links = find(report, "links");
  if (!links || links->empty() || !links->front().contains("utilisation")) return {};
  const Json& busiest = greatest(*links, "utilisation");
  double sum = 0;
  for (const Json& link : *links) sum += number_at(link, "utilisation");
  BusiestLink out{number_at(busiest, "utilisation"), sum / static_cast<double>(links->size()), ""};
  constexpr double kAlike = 1.02;
  if (links->size() > 1 && out.use <= kAlike * out.mean)
    out.text = fmt::format("Each link moves packets in {} of the cycles.", percent(out.mean));
  else
    out.text = fmt::format(
        "Of the links, that from {} to {} is busiest: it moves packets in {} of the cycles, where a link does in {} in "
        "the mean.",
        end_words(report, number_at(busiest, "from")), end_words(report, number_at(busiest, "to")), percent(out.use),
        percent(out.mean));
  return out;
}

Html machine_section(const Json& report, const Json& schema) {
  const Json* resources = find(report, "resources");
  const Json* links = find(report, "links");
  Html out, tables;
  double most = 0;
  std::string busiest;
  if (resources && !resources->empty()) {
    const std::vector<double> uses = uses_of_resources(report);
    const bool timed = resources->front().contains("units");
    Table table = table_of("resources", "Resources", *resources, *find(schema, "properties.resources.items"));
    table.columns.insert(table.columns.begin() + 1,
                         Column{timed ? "busiest unit" : "load", "",
                                timed ? "greatest share of the cycles in which a kind of its units was busy"
                                      : "rays tested, over those of the resource that tested most"});
    for (std::size_t i = 0; i < resources->size(); ++i) {
      const bool tests = i < uses.size();
      table.rows[i].insert(table.rows[i].begin() + 1, tests ? share(uses[i]) : cell(""));
      if (!tests || uses[i] <= most) continue;
      busiest = fmt::format("resource {}", table.rows[i][0].text);
      most = uses[i];
    }
    out += markup("<p>The colour of a resource is {}. Of all, {} is highest, with {}.</p>\n",
                  timed ? "the share of the cycles in which its busiest kind of unit was testing"
                        : "the number of rays that it tested, over that of the resource that tested most",
                  busiest.empty() ? "none" : busiest, share(most).text);
    tables += table.html();
  }
  if (report.contains("ranks")) {
    out += rank_words(report);
    tables += rank_table("ranks", "Ranks", report, schema);
    tables += rank_table("rank_links", "Messages between ranks", report, schema);
  }
  if (const Json* pools = find(report, "shading.pools"))
    tables += table_of("shading-pools", "Pools of shader workers", *pools,
                       schema_at(schema, "properties.shading.properties.pools.items"))
                  .html();
  if (links && !links->empty()) {
    Table table = table_of("links", "Links", *links, *find(schema, "properties.links.items"), {"utilisation"});
    double carried = 0;
    for (const Json& link : *links) carried = std::max(carried, number_at(link, "packets"));
    const bool timed = links->front().contains("utilisation");
    const Json* nodes = find(report, "drawing");
    if (nodes) table.columns.insert(table.columns.begin(), Column{"link", "", "by the names of the drawing"});
    const std::ptrdiff_t ends = nodes ? 3 : 2;
    table.columns.insert(table.columns.begin() + ends,
                         Column{timed ? "use" : "load", "",
                                timed ? "share of the cycles in which it moved a packet"
                                      : "packets, over those of the link that carried most"});
    for (std::size_t i = 0; i < links->size(); ++i) {
      const Json& link = (*links)[i];
      const double use = timed         ? number_at(link, "utilisation")
                         : carried > 0 ? number_at(link, "packets") / carried
                                       : 0;
      if (nodes) {
        const auto name = [&](const char* end) {
          return text_at((*nodes)[static_cast<std::size_t>(number_at(link, end))], "name");
        };
        table.rows[i].insert(table.rows[i].begin(), cell(name("from") + " > " + name("to")));
      }
      table.rows[i].insert(table.rows[i].begin() + ends, share(use));
    }
    tables += table.html();
    if (timed) out += markup("<p>{}</p>\n", busiest_link(report).text);
  }
  if (tables.empty()) return {};
  if (text_at(report, "config.topology.shape") == "central") return out + still_machine(report) + tables;
  out += Figure{.id = "fig-machine",
                .kind = "machine",
                .tables = "resources links",
                .title = "The machine, coloured by use",
                .label = fmt::format("Drawing of the machine: {}. The tables below have the use of each part.",
                                     machine_words(report)),
                .height = 460,
                .still = still_machine(report)}
             .html();
  return out + tables;
}

}  // namespace carousel::report::html
