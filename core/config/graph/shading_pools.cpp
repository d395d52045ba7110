#include "core/config/graph/shading_pools.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/routes.h"
#include "core/config/graph/way_time.h"

namespace carousel::config {

namespace {

using Nodes = std::vector<std::uint32_t>;

constexpr std::size_t kNoPool = std::numeric_limits<std::size_t>::max();

class PoolFinder {
 public:
  PoolFinder(const Graph& graph, DrawnParts& parts, std::vector<GraphIssue>& issues)
      : graph_(graph), parts_(parts), issues_(issues) {}

  bool find() {
    std::vector<std::size_t> of(graph_.resources, kNoPool);  // by collector
    std::vector<std::size_t> nearest;                        // pools that take what no `serves` names
    for (std::size_t pool = 0; pool < parts_.pools.size(); ++pool) {
      const GraphNode& drawn = *graph_.nodes[parts_.pools[pool]].drawn;
      if (drawn.serves.empty())
        nearest.push_back(pool);
      else if (!serve_rays(pool, of))
        return false;
    }
    if (!nearest.empty()) take_nearest(nearest, of);
    parts_.pool_of.resize(graph_.resources);
    for (std::uint32_t r = 0; r < graph_.resources; ++r) {
      parts_.pool_of[r] = of[collector(r)];
      if (parts_.pool_of[r] != kNoPool) continue;
      issues_.push_back(
          {"topology.nodes",
           fmt::format("no pool of workers shades the rays of {}; expected a node of the kind shading that serves it",
                       name(r))});
      return false;
    }
    return true;
  }

 private:
  const std::string& name(std::uint32_t node) const { return graph_.nodes[node].name; }

  /// The rays that a packet process collects are shaded by one pool.
  std::uint32_t collector(std::uint32_t resource) const {
    return graph_.manager_of.empty() ? resource : graph_.manager_of[resource];
  }

  /// Enters the resources that a pool names: of a group, each serves an equal run of them.
  bool serve_rays(std::size_t pool, std::vector<std::size_t>& of) {
    const Graph::Node& node = graph_.nodes[parts_.pools[pool]];
    const std::string key = fmt::format("topology.nodes.{}.serves", node.entry);
    const auto wrong = [&](std::string message) {
      issues_.push_back({key, std::move(message)});
      return false;
    };
    std::string error;
    const Nodes served = graph_.names.find(node.drawn->serves, error);
    if (served.empty()) return wrong(std::move(error));
    const auto count = static_cast<std::size_t>(node.drawn->count.value_or(1));
    if (served.size() % count != 0)
      return wrong(fmt::format("each of {0} pools serves as many; expected a multiple of {0} resources, found {1}",
                               count, served.size()));
    std::size_t place = 0;  // in the group
    while (place < pool && graph_.nodes[parts_.pools[pool - place - 1]].entry == node.entry) ++place;
    const std::size_t run = served.size() / count;
    for (std::size_t i = place * run; i < (place + 1) * run; ++i) {
      if (served[i] >= graph_.resources)
        return wrong(
            fmt::format("workers shade the rays of resources; expected such nodes, found {}", name(served[i])));
      std::size_t& entered = of[collector(served[i])];
      if (entered != kNoPool && entered != pool)
        return wrong(fmt::format("{} serves {} already, or another resource of its packet_process; expected one pool",
                                 name(parts_.pools[entered]), name(served[i])));
      entered = pool;
    }
    return true;
  }

  /// The resources that no pool names go to the nearest of these: by the time that the way of completed rays takes, or
  /// where these travel beside the links that of new ones. Of several as near, to the first.
  void take_nearest(const std::vector<std::size_t>& pools, std::vector<std::size_t>& of) const {
    const Carried what = parts_.completed_rays ? Carried::kCompletedRays : Carried::kNewRays;
    const Graph links = graph_.only(what);
    const Routes routes(links);
    for (std::uint32_t r = 0; r < graph_.resources; ++r) {
      if (collector(r) != r || of[r] != kNoPool) continue;
      std::int64_t least = std::numeric_limits<std::int64_t>::max();
      of[r] = pools.front();
      for (const std::size_t pool : pools) {
        const std::uint32_t node = parts_.pools[pool];
        const auto [from, to] = parts_.completed_rays ? std::pair{r, node} : std::pair{node, r};
        WayTime way(links);
        bool any = false;
        routes.for_each_link(from, to, [&](std::uint32_t link) {
          way.go(links.links[link]);
          any = true;
        });
        if (!any || way.cycles() >= least) continue;
        least = way.cycles();
        of[r] = pool;
      }
    }
  }

  const Graph& graph_;
  DrawnParts& parts_;
  std::vector<GraphIssue>& issues_;
};

}  // namespace

bool find_pools(const Graph& graph, DrawnParts& parts, std::vector<GraphIssue>& issues) {
  return PoolFinder(graph, parts, issues).find();
}

}  // namespace carousel::config
