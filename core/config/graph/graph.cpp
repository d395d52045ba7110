#include "core/config/graph/graph.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/served.h"

namespace carousel::config {

namespace {

using Nodes = std::vector<std::uint32_t>;

constexpr std::size_t kMaxDrawn = 1024;  // nodes of all kinds

/// Writes out nodes and then links.
class Drawing {
 public:
  Drawing(const TopologyConfig& config, std::vector<GraphIssue>& issues) : config_(config), issues_(issues) {}

  Graph draw() {
    if (drawn_resources(config_) > kMaxResources) {
      issue("topology.nodes",
            fmt::format("expected at most {} resources, found {}", kMaxResources, drawn_resources(config_)));
      return {};
    }
    for (const bool owners : {true, false}) {
      for (const auto& [kind, name] : kEnumNames<GraphNodeKind>)
        if (takes_packets(kind) == owners) add_nodes(kind);
      if (owners) graph_.resources = static_cast<std::uint32_t>(graph_.nodes.size());
    }
    if (graph_.nodes.size() > kMaxDrawn) {
      issue("topology.nodes", fmt::format("expected at most {} nodes, found {}", kMaxDrawn, graph_.nodes.size()));
      return {};
    }
    graph_.stacks = !properties_of(config_).has_packets;
    graph_.core_mhz = config_.core_mhz;
    graph_.synchroniser_cycles = config_.synchroniser_cycles;
    if (managers_of(config_) > 0) find_served(config_, graph_, issues_);
    for (entry_ = 0; entry_ < config_.links.size(); ++entry_) {
      const GraphLink& link = config_.links[entry_];
      const bool side_by_side = link.lane || link.lanes > 1;
      const std::int64_t first = link.lane.value_or(0);
      if (first + link.lanes > kMaxLanes) {
        link_issue("lanes", fmt::format("expected lanes up to {} at most, found {} to {}", kMaxLanes - 1, first,
                                        first + link.lanes - 1));
        continue;
      }
      const std::size_t before = issues_.size();
      for (std::int64_t i = 0; i < link.lanes && issues_.size() == before; ++i) {
        lane_ = side_by_side ? first + i : Graph::Link::kAllLanes;
        graph_.lanes = std::max(graph_.lanes, static_cast<std::size_t>(lane_ + 1));
        add_links(link);
      }
    }
    graph_.routing = config_.routes;
    if (graph_.routing == Routing::kUpDown && !config_.root.empty()) find_root();
    if (graph_.routing == Routing::kGiven)
      for (entry_ = 0; entry_ < config_.ways.size(); ++entry_) add_way(config_.ways[entry_]);
    return std::move(graph_);
  }

 private:
  void issue(const std::string& key, std::string message) { issues_.push_back({key, std::move(message)}); }
  std::string link_key(std::string_view key) const {
    return fmt::format("topology.links.{}{}{}", entry_, key.empty() ? "" : ".", key);
  }
  void link_issue(std::string_view key, std::string message) { issue(link_key(key), std::move(message)); }

  void add_nodes(GraphNodeKind kind) {
    for (std::size_t i = 0; i < config_.nodes.size(); ++i) {
      const GraphNode& node = config_.nodes[i];
      if (node.kind != kind || node.name.empty()) continue;
      const std::string key = fmt::format("topology.nodes.{}.name", i);
      if (!NodeNames::is_name(node.name)) {
        issue(key, fmt::format("expected a letter or _ and then letters, digits and _, found '{}'", node.name));
        continue;
      }
      if (!graph_.names.add(node.name, static_cast<std::uint32_t>(graph_.nodes.size()), node.count)) {
        issue(key, fmt::format("there is a node or group '{}' already", node.name));
        continue;
      }
      for (std::int64_t n = 0; n < node.count.value_or(1); ++n)
        graph_.nodes.push_back(
            {node.count ? fmt::format("{}[{}]", node.name, n) : node.name, &node, i, place_of(node, n)});
    }
  }

  static GraphPoint place_of(const GraphNode& node, std::int64_t n) {
    const std::int64_t columns = node.columns.value_or(node.count.value_or(1));
    GraphPoint at = node.at;
    at.x += node.step.x * static_cast<double>(n % columns);
    at.y += node.step.y * static_cast<double>(n / columns);
    return at;
  }

  void find_root() {
    std::string error;
    const Nodes nodes = graph_.names.find(config_.root, error);
    if (nodes.size() == 1)
      graph_.root = nodes[0];
    else
      issue("topology.root",
            nodes.empty() ? std::move(error)
                          : fmt::format("expected one node, found {}, which are {}", config_.root, nodes.size()));
  }

  void way_issue(std::string_view key, std::string message) {
    issue(fmt::format("topology.ways.{}{}{}", entry_, key.empty() ? "" : ".", key), std::move(message));
  }
  Nodes find_on_way(std::string_view key, const std::string& pattern) {
    std::string error;
    Nodes nodes = graph_.names.find(pattern, error);
    if (nodes.empty()) way_issue(key, std::move(error));
    return nodes;
  }

  void add_way(const GraphWay& way) {
    const bool table = !way.at.empty() || !way.to.empty() || !way.next.empty();
    if (way.along.empty() != table || (table && (way.at.empty() || way.to.empty() || way.next.empty())))
      return way_issue("", "expected along alone, or at, to and next");
    if (!table) {
      const Nodes nodes = find_on_way("along", way.along);
      if (nodes.empty()) return;
      if (nodes.size() < 2) return way_issue("along", "expected two nodes at least, found one");
      for (std::size_t i = 0; i + 1 < nodes.size(); ++i) add_hop("along", nodes[i], nodes.back(), nodes[i + 1]);
      return;
    }
    const Nodes at = find_on_way("at", way.at), to = find_on_way("to", way.to), next = find_on_way("next", way.next);
    if (next.size() > 1)
      return way_issue("next", fmt::format("expected one node, found {}, which are {}", way.next, next.size()));
    if (next.empty()) return;
    for (const std::uint32_t a : at)
      for (const std::uint32_t b : to)
        if (a != b) add_hop("next", a, b, next[0]);
  }

  void add_hop(std::string_view key, std::uint32_t at, std::uint32_t to, std::uint32_t next) {
    const auto name = [&](std::uint32_t node) -> const std::string& { return graph_.nodes[node].name; };
    if (to >= graph_.resources)
      return way_issue(key == "next" ? "to" : key, fmt::format("a way ends at a resource, and {} is none", name(to)));
    Nodes links;  // one a lane
    for (std::uint32_t i = 0; i < graph_.links.size(); ++i) {
      const Graph::Link& one = graph_.links[i];
      if (one.from == at && one.to == next && one.carries_any({Carried::kPackets})) links.push_back(i);
    }
    if (links.empty())
      return way_issue(key, fmt::format("expected nodes with a link between them, found {} and {}, which have none",
                                        name(at), name(next)));
    const auto [known, added] = hops_.emplace(std::pair{at, to}, graph_.hops.size());
    if (added) {
      for (const std::uint32_t link : links) graph_.hops.push_back({at, to, link, entry_});
      return;
    }
    const Graph::Hop& first = graph_.hops[known->second];
    if (graph_.links[first.link].to != next)
      way_issue(key, fmt::format("topology.ways.{} sends packets at {} for {} on to {}; expected the same, found {}",
                                 first.entry, name(at), name(to), name(graph_.links[first.link].to), name(next)));
  }

  Nodes find(std::string_view key, const std::string& pattern) {
    std::string error;
    Nodes nodes = graph_.names.find(pattern, error);
    if (nodes.empty()) link_issue(key, std::move(error));
    return nodes;
  }

  /// One of the five ways to say which nodes are linked.
  void add_links(const GraphLink& link) {
    const std::pair<std::string_view, bool> ways[] = {{"to", !link.to.empty()},
                                                      {"all_to", !link.all_to.empty()},
                                                      {"ring", !link.ring.empty()},
                                                      {"line", !link.line.empty()},
                                                      {"mesh", link.mesh.any()}};
    const auto given = std::count_if(std::begin(ways), std::end(ways), [](const auto& way) { return way.second; });
    if (given != 1) {
      std::string found;
      for (const auto& [key, is_given] : ways)
        if (is_given) found += fmt::format("{}{}", found.empty() ? "" : " and ", key);
      return link_issue("", fmt::format("expected one of from and to, from and all_to, ring, line or mesh, found {}",
                                        !found.empty()      ? found
                                        : link.from.empty() ? "none"
                                                            : "from alone"));
    }
    const bool starts = !link.to.empty() || !link.all_to.empty();
    if (starts == link.from.empty())
      return link_issue(starts ? "" : "from", starts
                                                  ? "expected from beside to or all_to"
                                                  : "a ring, a line or a mesh names all its nodes; expected no from");
    if (!link.of.empty() && !link.mesh.any())
      return link_issue("of", "only a mesh has nodes of its own; expected none");
    if (!link.to.empty())
      pairs(link);
    else if (!link.all_to.empty())
      product(link);
    else if (link.mesh.any())
      mesh(link);
    else
      chain(link, !link.ring.empty());
  }

  void pairs(const GraphLink& link) {
    Nodes from = find("from", link.from), to = find("to", link.to);
    if (from.empty() || to.empty()) return;
    if (from.size() == 1) from.resize(to.size(), from[0]);
    if (to.size() == 1) to.resize(from.size(), to[0]);
    if (from.size() != to.size())
      return link_issue("to", fmt::format("{} has {} nodes and {} has {}; expected as many, one on a side, or all_to",
                                          link.from, from.size(), link.to, to.size()));
    for (std::size_t i = 0; i < from.size(); ++i) add(link, from[i], to[i]);
  }

  void product(const GraphLink& link) {
    const Nodes from = find("from", link.from), to = find("all_to", link.all_to);
    for (const std::uint32_t a : from)
      for (const std::uint32_t b : to)
        if (a != b) add(link, a, b);
  }

  void chain(const GraphLink& link, bool closed) {
    const Nodes nodes = closed ? find("ring", link.ring) : find("line", link.line);
    if (nodes.empty()) return;
    if (nodes.size() < 2)
      return link_issue(closed ? "ring" : "line", fmt::format("expected two nodes at least, found {}", nodes.size()));
    for (std::size_t i = 0; i < nodes.size() && closed; ++i)
      if (std::count(nodes.begin(), nodes.end(), nodes[i]) > 1)
        return link_issue("ring", fmt::format("expected each node once, found {} twice", graph_.nodes[nodes[i]].name));
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) add(link, nodes[i], nodes[i + 1]);
    if (closed && !(link.both && nodes.size() == 2)) add(link, nodes.back(), nodes.front());
  }

  void mesh(const GraphLink& link) {
    Nodes nodes;
    if (link.of.empty())
      for (std::uint32_t r = 0; r < graph_.resources; ++r) nodes.push_back(r);
    else if (nodes = find("of", link.of); nodes.empty())
      return;
    const auto columns = static_cast<std::size_t>(link.mesh.columns), rows = static_cast<std::size_t>(link.mesh.rows);
    if (columns * rows != nodes.size())
      return link_issue(
          "mesh", fmt::format("expected as many places as {} has nodes, {}, found {} x {} = {}",
                              link.of.empty() ? "the graph" : link.of, nodes.size(), columns, rows, columns * rows));
    GraphLink both = link;
    both.both = true;
    for (std::size_t at = 0; at < nodes.size(); ++at) {
      if (at % columns + 1 < columns) add(both, nodes[at], nodes[at + 1]);
      if (at + columns < nodes.size()) add(both, nodes[at], nodes[at + columns]);
    }
  }

  /// Tells whether something may go over both of two links.
  static bool may_meet(const std::vector<Carried>& a, const std::vector<Carried>& b) {
    std::vector<Carried> common;
    std::ranges::set_intersection(a, b, std::back_inserter(common));
    return !common.empty();
  }

  void add(const GraphLink& link, std::uint32_t from, std::uint32_t to) {
    add_one_way(link, from, to);
    if (link.both) add_one_way(link, to, from);
  }

  void add_one_way(const GraphLink& link, std::uint32_t from, std::uint32_t to) {
    const auto name = [&](std::uint32_t node) -> const std::string& { return graph_.nodes[node].name; };
    if (from == to)
      return link_issue("", fmt::format("a link leads from {0} to {0}; expected another node", name(from)));
    std::vector<Carried> carries = link.carries;
    std::ranges::sort(carries);
    std::vector<Beside>& beside = entries_[{from, to}];
    const auto same = std::ranges::find_if(beside, [&](const Beside& other) {
      constexpr std::int64_t kAll = Graph::Link::kAllLanes;
      return (lane_ == kAll || other.lane == kAll || other.lane == lane_) && may_meet(carries, other.carries);
    });
    if (same != beside.end())
      return link_issue("", fmt::format("a second link from {} to {}, beside that of topology.links.{}; expected one, "
                                        "twice as wide for example, or several with lanes of their own, or that carry "
                                        "something else",
                                        name(from), name(to), same->entry));
    beside.push_back({lane_, entry_, carries});
    const LinkConfig& all = config_.link;
    for (std::int64_t ring = 0; ring < link.stops.rings; ++ring)
      graph_.links.push_back({from, to, link.latency_cycles.value_or(all.latency_cycles),
                              link.bytes_per_cycle.value_or(all.bytes_per_cycle), link.depth.value_or(all.depth),
                              link.virtual_channels.value_or(all.virtual_channels), entry_, link.dateline, carries,
                              lane_, link.clock, link.mhz, link.queue});
  }

  const TopologyConfig& config_;
  std::vector<GraphIssue>& issues_;
  Graph graph_;
  struct Beside {
    std::int64_t lane;
    std::size_t entry;
    std::vector<Carried> carries;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Beside>> entries_;  // by the link's nodes
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> hops_;             // by node and destination
  std::size_t entry_ = 0;
  std::int64_t lane_ = Graph::Link::kAllLanes;  // of the links that are added
};

}  // namespace

bool Graph::Link::carries_any(std::initializer_list<Carried> some) const {
  return std::ranges::any_of(some, [&](Carried one) { return std::ranges::binary_search(carries, one); });
}

std::vector<std::uint32_t> Graph::of_kind(GraphNodeKind kind) const {
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].drawn->kind == kind) out.push_back(i);
  return out;
}

Graph Graph::only(Carried what) const {
  Graph out = *this;
  out.links.clear();
  out.hops.clear();
  std::vector<std::uint32_t> numbers(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i].carries_any({what})) continue;
    numbers[i] = static_cast<std::uint32_t>(out.links.size());
    out.links.push_back(links[i]);
  }
  if (what == Carried::kPackets) {
    for (Hop hop : hops) {
      hop.link = numbers[hop.link];
      out.hops.push_back(hop);
    }
  } else {
    out.routing = Routing::kShortest;
  }
  return out;
}

std::optional<std::uint32_t> Graph::bus() const {
  const std::vector<std::uint32_t> buses = of_kind(GraphNodeKind::kBus);
  return buses.empty() ? std::nullopt : std::optional(buses.front());
}

bool Graph::lanes_meet() const {
  return lanes > 1 && std::ranges::any_of(links, [](const Link& link) { return link.lane == Link::kAllLanes; });
}

std::int64_t drawn_resources(const TopologyConfig& config) {
  std::int64_t sum = 0;
  for (const GraphNode& node : config.nodes)
    if (takes_packets(node.kind)) sum += node.count.value_or(1);
  return sum;
}

void name_overrides(TopologyConfig& config) {
  const bool any = std::ranges::any_of(config.overrides, [](const auto& one) { return !one.nodes.empty(); });
  if (!any) return;
  std::vector<GraphIssue> ignored;
  std::string error;
  const Graph graph = draw_graph(config, ignored);
  for (ResourceOverride& one : config.overrides) {
    one.named.clear();
    if (one.nodes.empty()) continue;
    for (const std::uint32_t node : graph.names.find(one.nodes, error))
      if (node < graph.resources) one.named.push_back(node);
  }
}

Graph draw_graph(const TopologyConfig& config, std::vector<GraphIssue>& issues) {
  return Drawing(config, issues).draw();
}

}  // namespace carousel::config
