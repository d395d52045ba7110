#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

/// A table by depth with a heat map above it.
Html depths(const std::string& id, const std::string& caption, const Json* list, const Json& item_schema,
            const std::string& label) {
  if (!list || list->empty()) return {};
  const Table table = table_of(id, caption, *list, item_schema);
  return Figure{.id = "fig-" + id,
                .kind = "heat",
                .tables = table.id,
                .title = table.caption,
                .label = label,
                .height = 140 + 24 * static_cast<int>(table.columns.size())}
             .html() +
         table.html();
}

/// The links of the flow of rays. Bounces far down the path share a place.
class Flow {
 public:
  explicit Flow(std::string source) : source_(std::move(source)) {}

  void add(const Json& row) {
    const auto bounce = static_cast<std::uint64_t>(number_at(row, "bounce"));
    const std::string here = name(bounce), next = name(bounce + 1);
    if (bounce > 0 || source_ != "camera") link(source_, here, number_at(row, "begun"));
    link(source_, kShadow, number_at(row, "shadow_begun"));
    if (next != here) link(here, next, number_at(row, "went_on"));
    link(here, "escaped", number_at(row, "escaped"));
    link(here, "absorbed", number_at(row, "absorbed"));
    link(here, kShadow, number_at(row, "shadow") - number_at(row, "shadow_begun") - number_at(row, "passed"));
    link(kShadow, "reached a light", number_at(row, "lit"));
    link(kShadow, "occluded", number_at(row, "occluded"));
  }

  Table table() const {
    Table out{"ray-flow", "Way of the rays", {{"from"}, {"to"}, {"rays"}}};
    for (const Link& l : links_)
      out.rows.push_back({cell(l.from), cell(l.to), cell(Json(static_cast<std::uint64_t>(l.rays)))});
    return out;
  }

 private:
  static constexpr const char* kShadow = "shadow rays";
  static constexpr std::uint64_t kShown = 8;  // bounces
  struct Link {
    std::string from, to;
    double rays;
  };

  static std::string name(std::uint64_t bounce) {
    return bounce == 0 ? "camera rays" : bounce <= kShown ? fmt::format("bounce {}", bounce) : "later bounces";
  }
  void link(const std::string& from, const std::string& to, double rays) {
    if (rays <= 0) return;
    for (Link& l : links_)
      if (l.from == from && l.to == to) {
        l.rays += rays;
        return;
      }
    links_.push_back({from, to, rays});
  }

  std::string source_;
  std::vector<Link> links_;
};

}  // namespace

Html depth_section(const Json& report, const Json& schema) {
  Html out;
  if (const Json* levels = find(report, "structure.levels"))
    out += table_of("structure-levels", "The structure, level by level", *levels,
                    schema_at(schema, "properties.structure.properties.levels.items"))
               .html();
  if (const Json* rows = find(report, "structure.depths"))
    out += table_of("structure-depths", "The structure, depth by depth", *rows,
                    schema_at(schema, "properties.structure.properties.depths.items"))
               .html();
  Html nodes = depths("node-depths", "Nodes by depth, and the work at them", find(report, "nodes.by_depth"),
                      schema_at(schema, "properties.nodes.properties.by_depth.items"),
                      "Heat map of nodes, visits, tests, hits and misses, by depth.");
  const bool treelets =
      text_at(report, "config.collections.traversal") == "treelet" || find(report, "structure.treelets") != nullptr;
  if (!nodes.empty() && treelets)
    out += markup("<p>A treelet is gone through in one visit: its tests stand at the depth of its root.</p>\n");
  out += nodes;
  out += depths("bundle-depths", "Bundles by depth", find(report, "tests.bundles.by_depth"),
                schema_at(schema, "properties.tests.properties.bundles.properties.by_depth.items"),
                "Heat map of the outcomes of bundles, by depth.");
  return out + depths("cull-depths", "Cull planes by depth", find(report, "cull_planes.levels"),
                      schema_at(schema, "properties.cull_planes.properties.levels.items"),
                      "Heat map of the work that cull planes spare, by depth.");
}

Html rays_section(const Json& report, const Json& schema) {
  const Json* bounces = find(report, "rays.by_bounce");
  if (!bounces || bounces->empty()) return {};
  Flow links(find(report, "raster")                                   ? "raster pass"
             : text_at(report, "config.workload.kind") == "rays_from" ? "file"
                                                                      : "camera");
  double passed = 0;
  for (const Json& row : *bounces) {
    links.add(row);
    passed += number_at(row, "passed");
  }
  const Table flow = links.table();
  if (flow.rows.empty()) return {};
  Html out = markup(
      "<p>A hit may send out a ray of the next bounce and a shadow ray, so more rays may leave a place than come to "
      "it.");
  if (passed > 0) out += markup(" {} shadow rays went on behind a pane.", value_text(Json(passed)));
  return out + markup("</p>\n") +
         Figure{.id = "fig-rays",
                .kind = "flow",
                .tables = flow.id,
                .title = flow.caption,
                .label = "Flow of rays from the camera through the bounces to where they end; the table has each link.",
                .height = 320}
             .html() +
         flow.html() +
         table_of("ray-bounces", "Rays by bounce", *bounces,
                  schema_at(schema, "properties.rays.properties.by_bounce.items"))
             .html();
}

Html tests_section(const Json& report, const Json& schema) {
  const Json* tests = find(report, "tests");
  if (!tests) return {};
  Table table{"tests-table",
              "Tests and other work for each completed ray",
              {{"work"}, {"this machine"}, {"depth first"}, {"ratio"}, {"in all"}, {"meaning"}}};
  for (const auto& [key, value] : tests->items()) {
    if (!value.is_object() || !value.contains("per_ray")) continue;
    const Json* baseline = find(*tests, "depth_first." + key + ".per_ray");
    const double here = number_at(value, "per_ray"), there = baseline ? baseline->get<double>() : 0;
    if (here == 0 && there == 0) continue;
    table.rows.push_back({cell(words(key)), cell(value["per_ray"]), baseline ? cell(*baseline) : cell("–"),
                          cell(there > 0 ? fmt::format("{:.2f} times", here / there) : "–"), cell(value["count"]),
                          cell(text_at(schema, "properties.tests.properties." + key + ".description"))});
  }
  if (table.rows.empty()) return {};
  Html out;
  if (const double rays = number_at(*tests, "depth_first.rays"), one_in = number_at(*tests, "depth_first.one_in");
      rays > 0)
    out = markup(
        "<p>Depth first: a tracer that takes one ray after another down the same structure, nearest child first. It "
        "traced {} of the run.</p>\n",
        one_in > 1 ? fmt::format("{} rays, one in {}", value_text((*tests)["depth_first"]["rays"]), one_in)
                   : fmt::format("all {} rays", value_text((*tests)["depth_first"]["rays"])));
  return out +
         Figure{.id = "fig-tests",
                .kind = "groups",
                .tables = table.id,
                .title = table.caption,
                .label = "Bars: work for each completed ray, by kind, on this machine and depth first.",
                .height = bars_height(table) + 30}
             .html() +
         table.html();
}

}  // namespace carousel::report::html
