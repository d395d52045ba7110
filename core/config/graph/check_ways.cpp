#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/graph.h"
#include "core/config/graph/routes.h"
#include "core/types/added_names.h"

namespace carousel::config {

namespace {

using Nodes = std::vector<std::uint32_t>;

/// The fault of the way from one resource to another, if it is never reached.
std::optional<GraphIssue> fault_of(const Graph& graph, std::size_t lane, const Routes& routes, std::uint32_t from,
                                   std::uint32_t to) {
  std::uint32_t at = from;
  for (std::size_t links = 0; at != to; ++links) {
    const std::uint32_t link = routes.link(at, to);
    if (link == Routes::kNone) {
      const std::string rule = graph.routing == Routing::kUpDown ? " that goes up and then down"
                               : is_added(graph.routing)         ? fmt::format(" of {}", enum_name(graph.routing))
                                                                 : "";
      const std::string where = graph.lanes > 1 ? fmt::format(" in lane {}", lane) : "";
      return GraphIssue{"topology.links",
                        fmt::format("there is no way{}{} from {} to {}; expected links that lead there", rule, where,
                                    graph.nodes[from].name, graph.nodes[to].name)};
    }
    at = graph.links[link].to;
    if (links < graph.nodes.size()) continue;
    // It goes round: what is given sends it there.
    const auto given = std::ranges::find_if(graph.hops, [&](const Graph::Hop& hop) {
      return hop.to == to && hop.at == at && hop.link == routes.link(at, to);
    });
    if (given != graph.hops.end())
      return GraphIssue{fmt::format("topology.ways.{}", given->entry),
                        fmt::format("a packet from {0} for {1} never comes there: it goes round past {2}; expected a "
                                    "way that ends",
                                    graph.nodes[from].name, graph.nodes[to].name, graph.nodes[at].name)};
    if (is_added(graph.routing))
      return GraphIssue{"topology.routes", fmt::format("{} sends packets from {} for {} round in circles, past {}; "
                                                       "expected a router whose ways end",
                                                       enum_name(graph.routing), graph.nodes[from].name,
                                                       graph.nodes[to].name, graph.nodes[at].name)};
  }
  return std::nullopt;
}

/// A bus takes packets from resources straight to resources: it has a link to each and from each, and packets have no
/// other links.
void check_bus_links(const Graph& graph, std::uint32_t bus, std::vector<GraphIssue>& issues) {
  const std::string& name = graph.nodes[bus].name;
  const auto key = [](std::size_t entry) { return fmt::format("topology.links.{}", entry); };
  for (std::uint32_t i = graph.resources; i < graph.nodes.size(); ++i)
    if (const GraphNodeKind kind = graph.nodes[i].drawn->kind;
        i != bus && (kind == GraphNodeKind::kBus || kind == GraphNodeKind::kRouter))
      return issues.push_back({fmt::format("topology.nodes.{}.kind", graph.nodes[i].entry),
                               fmt::format("all packets cross the bus {}; expected no router and no other bus, found "
                                           "{}",
                                           name, graph.nodes[i].name)});
  std::vector<std::uint32_t> there(graph.resources), back(graph.resources);
  for (const Graph::Link& link : graph.links) {
    const bool ends = link.from == bus || link.to == bus;
    const std::uint32_t other = link.from == bus ? link.to : link.from;
    const bool packets = link.carries_any({Carried::kPackets});
    if (!ends && !packets) continue;
    if (ends && packets && other < graph.resources && link.carries.size() == 1 && link.lane == Graph::Link::kAllLanes) {
      ++(link.from == bus ? back : there)[other];
      continue;
    }
    return issues.push_back(
        {key(link.entry), fmt::format("the bus {} moves packets from resources to resources, and nothing else; "
                                      "expected links between it and them that carry packets alone, found {}",
                                      name, graph.name_of(link))});
  }
  for (std::uint32_t r = 0; r < graph.resources; ++r)
    if (there[r] != 1 || back[r] != 1)
      return issues.push_back({"topology.links", fmt::format("expected a link from {0} to the bus {1} and one back, "
                                                             "found {2} and {3}",
                                                             graph.nodes[r].name, name, there[r], back[r])});
}

}  // namespace

std::vector<std::vector<bool>> ways_of(const Graph& graph, const std::vector<std::uint32_t>& starts) {
  std::vector<std::vector<std::uint32_t>> next(graph.nodes.size());
  for (const Graph::Link& link : graph.links) next[link.from].push_back(link.to);
  std::vector<std::vector<bool>> out;
  for (const std::uint32_t start : starts) {
    std::vector<bool>& reached = out.emplace_back(graph.nodes.size());
    std::vector<std::uint32_t> open{start};
    reached[start] = true;
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      for (const std::uint32_t to : next[at]) {
        if (reached[to]) continue;
        reached[to] = true;
        open.push_back(to);
      }
    }
  }
  return out;
}

void check_ways(const Graph& graph, std::vector<GraphIssue>& issues) {
  if (graph.nodes.size() < 2) return;
  std::vector<bool> left(graph.nodes.size()), reached(graph.nodes.size());
  for (const Graph::Link& link : graph.links) left[link.from] = reached[link.to] = true;
  bool all = true;
  for (std::uint32_t i = 0; i < graph.nodes.size(); ++i) {
    const bool none = !left[i] && !reached[i];
    const bool dead_end = graph.nodes[i].drawn->kind == GraphNodeKind::kRouter && left[i] != reached[i];
    if (!(none || dead_end) || (graph.stacks && i < graph.resources)) continue;
    all = all && i >= graph.resources;
    issues.push_back({fmt::format("topology.nodes.{}", graph.nodes[i].entry),
                      fmt::format("{} has no link{}; expected one to it and one from it", graph.nodes[i].name,
                                  none      ? ""
                                  : left[i] ? " to it"
                                            : " from it")});
  }
  if (!all) return;  // the ways that are missing are those
  if (graph.resources < 2 || graph.stacks) return;
  if (const auto bus = graph.bus()) return check_bus_links(graph, *bus, issues);
  const Graph packets = graph.only(Carried::kPackets);
  for (std::size_t lane = 0; lane < packets.lanes; ++lane) {
    const Routes routes(packets, lane);
    for (std::uint32_t from = 0; from < graph.resources; ++from)
      for (std::uint32_t to = 0; to < graph.resources; ++to) {
        if (!graph.packets_go(from, to)) continue;
        if (std::optional<GraphIssue> fault = fault_of(packets, lane, routes, from, to)) {
          issues.push_back(std::move(*fault));
          return;  // one names the gap; there may be thousands
        }
      }
  }
}

}  // namespace carousel::config
