#include "core/config/graph/drawn_parts.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/shading_pools.h"

namespace carousel::config {

namespace {

using Nodes = std::vector<std::uint32_t>;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

class PartFinder {
 public:
  PartFinder(const TopologyConfig& config, const Graph& graph, std::int64_t line_bytes, std::vector<GraphIssue>& issues)
      : config_(config), graph_(graph), line_bytes_(line_bytes), issues_(issues) {}

  DrawnParts find() {
    caches();
    memories();
    shading();
    return std::move(parts_);
  }

 private:
  void issue(std::string key, std::string message) { issues_.push_back({std::move(key), std::move(message)}); }
  const std::string& name(std::uint32_t node) const { return graph_.nodes[node].name; }
  static std::string node_key(std::size_t entry, const char* key) {
    return fmt::format("topology.nodes.{}{}", entry, key);
  }
  /// The first link that carries `what`; null if there is none.
  const Graph::Link* carrier(Carried what) const {
    const auto found =
        std::ranges::find_if(graph_.links, [&](const Graph::Link& link) { return link.carries_any({what}); });
    return found == graph_.links.end() ? nullptr : &*found;
  }
  /// Nothing has to travel.
  void refuse_carrier(Carried what, const char* expected) {
    if (const Graph::Link* link = carrier(what))
      issue(fmt::format("topology.links.{}.carries", link->entry),
            fmt::format("nothing of the kind {} travels; expected {}", enum_name(what), expected));
  }

  Nodes all_resources() const {
    Nodes out(graph_.resources);
    std::iota(out.begin(), out.end(), 0u);
    return out;
  }
  /// A packet process that serves resources reads no shapes: these do.
  bool asks(std::uint32_t resource) const {
    return graph_.manager_of.empty() || graph_.manager_of[resource] != resource;
  }
  /// It asks for spilled collections alone.
  bool spills(std::uint32_t process) const { return std::ranges::count(parts_.spilling, process) > 0; }
  Nodes asking() const {
    Nodes out;
    for (std::uint32_t r = 0; r < graph_.resources; ++r)
      if (asks(r)) out.push_back(r);
    return out;
  }

  std::int64_t interleave(std::size_t entry) {
    const std::int64_t bytes = config_.nodes[entry].interleave_bytes.value_or(line_bytes_);
    if (bytes % line_bytes_ != 0)
      issue(node_key(entry, ".interleave_bytes"),
            fmt::format("a node holds whole lines; expected a multiple of memory.line_bytes = {}, found {}",
                        line_bytes_, bytes));
    return bytes;
  }

  void caches() {
    for (const std::uint32_t node : graph_.of_kind(GraphNodeKind::kCache)) {
      const std::size_t entry = graph_.nodes[node].entry;
      if (parts_.caches.empty() || graph_.nodes[parts_.caches.back().nodes.front()].entry != entry)
        parts_.caches.push_back({{}, interleave(entry)});
      parts_.caches.back().nodes.push_back(node);
    }
    if (parts_.caches.empty())
      return refuse_carrier(Carried::kShapes, graph_.stacks ? "a node of the kind cache, or links without them"
                                                            : "a node of the kind cache, or packets alone");
    parts_.caches_of.assign(graph_.resources, kNone);
    const std::size_t before = issues_.size();
    for (std::size_t group = 0; group < parts_.caches.size(); ++group) serve(group);
    if (issues_.size() > before) return;  // the resources that ask nobody are those
    bool all = true;
    for (const std::uint32_t r : asking()) {
      if (parts_.caches_of[r] != kNone) continue;
      if (all)
        issue(
            "topology.nodes",
            fmt::format("{} has no memory: no cache serves it; expected a node of the kind cache that does", name(r)));
      all = false;
    }
    if (!all) return;
    // The port of a packet process that no cache serves, which nothing uses, is at one of its resources'.
    for (std::uint32_t r = graph_.resources; r-- > 0;)
      if (asks(r) && !graph_.manager_of.empty() && !spills(graph_.manager_of[r]))
        parts_.caches_of[graph_.manager_of[r]] = parts_.caches_of[r];
    const Graph shapes = graph_.only(Carried::kShapes);
    for (std::size_t group = 0; group < parts_.caches.size(); ++group) {
      Nodes clients;
      for (std::uint32_t r = 0; r < graph_.resources; ++r)
        if (parts_.caches_of[r] == group && (asks(r) || spills(r))) clients.push_back(r);
      if (!there_and_back(shapes, Carried::kShapes, clients, parts_.caches[group].nodes)) return;
    }
  }

  /// Enters the resources of a group of caches.
  void serve(std::size_t group) {
    const std::size_t entry = graph_.nodes[parts_.caches[group].nodes.front()].entry;
    const std::string& pattern = config_.nodes[entry].serves;
    Nodes served;
    std::string error;
    if (pattern.empty())
      served = asking();
    else if (served = graph_.names.find(pattern, error); served.empty())
      return issue(node_key(entry, ".serves"), std::move(error));
    for (const std::uint32_t node : served) {
      if (node >= graph_.resources)
        return issue(node_key(entry, ".serves"), fmt::format("expected resources, found {}", name(node)));
      if (parts_.caches_of[node] != kNone && parts_.caches_of[node] != group)
        return issue(node_key(entry, pattern.empty() ? ".name" : ".serves"),
                     fmt::format("{} asks {} already; expected one group of caches for each resource", name(node),
                                 name(parts_.caches[parts_.caches_of[node]].nodes.front())));
      if (!asks(node) && parts_.caches_of[node] == kNone) parts_.spilling.push_back(node);
      parts_.caches_of[node] = group;
    }
  }

  void memories() {
    for (const std::uint32_t node : graph_.of_kind(GraphNodeKind::kMemory)) {
      const std::size_t entry = graph_.nodes[node].entry;
      const std::int64_t bytes = interleave(entry);
      if (!parts_.memories.nodes.empty() && parts_.memories.interleave_bytes != bytes)
        issue(node_key(entry, ".interleave_bytes"),
              fmt::format("all memories hold lines in turn; expected {} as of {}, found {}",
                          parts_.memories.interleave_bytes, name(parts_.memories.nodes.front()), bytes));
      parts_.memories.interleave_bytes = bytes;
      parts_.memories.nodes.push_back(node);
    }
    if (parts_.memories.nodes.empty()) return;
    const std::size_t first = graph_.nodes[parts_.memories.nodes.front()].entry;
    if (parts_.caches.empty())
      return issue(node_key(first, ".kind"), "a memory answers caches; expected a node of the kind cache beside it");
    Nodes caches;
    for (const Banks& group : parts_.caches) caches.insert(caches.end(), group.nodes.begin(), group.nodes.end());
    there_and_back(graph_.only(Carried::kShapes), Carried::kShapes, caches, parts_.memories.nodes);
  }

  void shading() {
    parts_.pools = graph_.of_kind(GraphNodeKind::kShading);
    if (parts_.pools.empty()) {
      refuse_carrier(Carried::kNewRays, "a node of the kind shading, or links without them");
      return refuse_carrier(Carried::kCompletedRays, "a node of the kind shading, or links without them");
    }
    parts_.new_rays = carrier(Carried::kNewRays) != nullptr;
    parts_.completed_rays = carrier(Carried::kCompletedRays) != nullptr;
    const std::uint32_t first = parts_.pools.front();
    if (!parts_.new_rays && !parts_.completed_rays)
      return issue(
          node_key(graph_.nodes[first].entry, ".kind"),
          fmt::format("no rays travel to {} or from it; expected links with carries: [new_rays, completed_rays]",
                      name(first)));
    if (!find_pools(graph_, parts_, issues_)) return;
    const Graph new_rays = graph_.only(Carried::kNewRays), completed = graph_.only(Carried::kCompletedRays);
    for (std::size_t pool = 0; pool < parts_.pools.size(); ++pool) {
      Nodes resources;
      for (const std::uint32_t r : all_resources())
        if (parts_.pool_of[r] == pool) resources.push_back(r);
      const Nodes here{parts_.pools[pool]};
      if (resources.empty())
        return issue(node_key(graph_.nodes[here[0]].entry, ".kind"),
                     fmt::format("no rays come to {}, as other pools are nearer to all resources, or serve them; "
                                 "expected `serves`, or fewer nodes of the kind shading",
                                 name(here[0])));
      if (parts_.new_rays && !one_way(new_rays, Carried::kNewRays, here, resources)) return;
      if (parts_.completed_rays && !one_way(completed, Carried::kCompletedRays, resources, here)) return;
    }
  }

  bool there_and_back(const Graph& links, Carried what, const Nodes& from, const Nodes& to) {
    return one_way(links, what, from, to) && one_way(links, what, to, from);
  }
  /// Names the first gap of the ways from each to each, if there is any. Returns whether there is none.
  bool one_way(const Graph& links, Carried what, const Nodes& from, const Nodes& to) {
    const std::vector<std::vector<bool>> ways = ways_of(links, from);
    for (std::size_t i = 0; i < from.size(); ++i)
      for (const std::uint32_t end : to) {
        if (ways[i][end]) continue;
        issue("topology.links", fmt::format("there is no way from {} to {} over links that carry {}; expected links "
                                            "with carries: [{}] that lead there",
                                            name(from[i]), name(end), enum_name(what), enum_name(what)));
        return false;
      }
    return true;
  }

  const TopologyConfig& config_;
  const Graph& graph_;
  std::int64_t line_bytes_;
  std::vector<GraphIssue>& issues_;
  DrawnParts parts_;
};

}  // namespace

std::size_t DrawnParts::cache_nodes() const {
  std::size_t sum = 0;
  for (const Banks& group : caches) sum += group.nodes.size();
  return sum;
}

DrawnParts find_parts(const TopologyConfig& config, const Graph& graph, std::int64_t line_bytes,
                      std::vector<GraphIssue>& issues) {
  return PartFinder(config, graph, line_bytes, issues).find();
}

}  // namespace carousel::config
