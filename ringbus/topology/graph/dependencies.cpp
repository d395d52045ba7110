#include "ringbus/topology/graph/dependencies.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace carousel::ringbus {

namespace {

constexpr std::uint64_t kNoPlaces = std::numeric_limits<std::uint64_t>::max();

/// Adds the dependencies of the links of one way.
void add_way(Dependencies& out, const Routes& routes, std::uint32_t from, std::uint32_t to) {
  std::uint32_t before = Routes::kNone;
  routes.for_each_link(from, to, [&](std::uint32_t link) {
    if (before != Routes::kNone) out.add(before, link);
    before = link;
  });
}

}  // namespace

void Dependencies::add(std::uint32_t link, std::uint32_t next) {
  std::vector<std::uint32_t>& after = after_[link];
  if (std::find(after.begin(), after.end(), next) == after.end()) after.push_back(next);
}

/// Links from which and to which nothing that is left leads are no part of a circle. What remains may be.
std::vector<bool> Dependencies::on_circles() const {
  std::vector<std::uint32_t> waits(after_.size());
  for (const auto& after : after_)
    for (const std::uint32_t next : after) ++waits[next];
  std::vector<bool> left(after_.size(), true);
  std::vector<std::uint32_t> open;
  for (std::uint32_t link = 0; link < after_.size(); ++link)
    if (waits[link] == 0) open.push_back(link);
  while (!open.empty()) {
    const std::uint32_t link = open.back();
    open.pop_back();
    left[link] = false;
    for (const std::uint32_t next : after_[link])
      if (--waits[next] == 0) open.push_back(next);
  }
  return left;
}

std::vector<std::uint32_t> Dependencies::smallest_circle(const std::vector<std::uint64_t>& places,
                                                         std::uint64_t enough) const {
  const std::vector<bool> candidates = on_circles();
  std::vector<std::uint32_t> circle;
  std::uint64_t least = kNoPlaces;
  std::vector<std::uint64_t> held(after_.size());
  std::vector<std::uint32_t> before(after_.size());
  using Entry = std::pair<std::uint64_t, std::uint32_t>;  // packets held so far, and the link
  for (std::uint32_t start = 0; start < after_.size() && least > enough; ++start) {
    if (!candidates[start]) continue;
    std::fill(held.begin(), held.end(), kNoPlaces);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    open.emplace(0, start);
    while (!open.empty()) {
      const auto [so_far, link] = open.top();
      open.pop();
      if (so_far >= least) break;
      if (link == start && held[start] != kNoPlaces) {  // back again
        least = so_far;
        circle.clear();
        for (std::uint32_t at = before[start]; at != start; at = before[at]) circle.push_back(at);
        circle.push_back(start);
        std::reverse(circle.begin(), circle.end());
        break;
      }
      if (link != start && so_far > held[link]) continue;
      for (const std::uint32_t next : after_[link]) {
        if (const std::uint64_t there = so_far + places[next]; there < held[next] && there < least) {
          held[next] = there;
          before[next] = link;
          open.emplace(there, next);
        }
      }
    }
  }
  return circle;
}

Dependencies traffic_dependencies(const config::Graph& graph, const Routes& routes) {
  Dependencies out(graph.links.size());
  for (std::uint32_t from = 0; from < graph.resources; ++from)
    for (std::uint32_t to = 0; to < graph.resources; ++to) add_way(out, routes, from, to);
  return out;
}

Dependencies visit_dependencies(const config::Graph& graph, const Routes& routes, std::span<const ResourceId> round,
                                const std::vector<bool>& bounded) {
  Dependencies ways(graph.links.size());
  const std::uint32_t n = graph.resources;
  // By resource: the links by which packets come to visit it, and those by which they leave.
  std::vector<std::vector<std::uint32_t>> come(n), leave(n);
  for (std::uint32_t from = 0; from < n; ++from)
    for (std::uint32_t to = 0; to < n; ++to) {
      if (from == to || !graph.packets_go(from, to) || (!round.empty() && to != round[from].value)) continue;
      add_way(ways, routes, from, to);
      std::uint32_t first = Routes::kNone, last = Routes::kNone;
      routes.for_each_link(from, to, [&](std::uint32_t link) {
        if (first == Routes::kNone) first = link;
        last = link;
      });
      if (first == Routes::kNone) continue;
      leave[from].push_back(first);
      come[to].push_back(last);
    }
  const auto sort = [](std::vector<std::uint32_t>& links) {
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
  };
  for (std::uint32_t r = 0; r < n; ++r) {
    sort(come[r]);
    sort(leave[r]);
  }
  Dependencies out(graph.links.size());
  for (std::uint32_t link = 0; link < graph.links.size(); ++link) {
    const std::uint32_t at = graph.links[link].to;
    if (!bounded[at]) continue;
    std::vector<std::uint32_t> next = ways.after(link);
    if (at < n && std::binary_search(come[at].begin(), come[at].end(), link))
      next.insert(next.end(), leave[at].begin(), leave[at].end());
    sort(next);
    out.set(link, std::move(next));
  }
  return out;
}

void join_stop_rings(Dependencies& waits, const config::Graph& graph, const std::vector<config::StopRing>& rings,
                     const std::vector<bool>& bounded) {
  for (const config::StopRing& ring : rings) {
    std::vector<std::uint32_t> next;
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i) {
      if (!bounded[graph.links[i].to]) continue;
      for (const std::uint32_t link : waits.after(static_cast<std::uint32_t>(i)))
        if (!ring.owns(link)) next.push_back(link);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i) waits.set(static_cast<std::uint32_t>(i), next);
  }
}

}  // namespace carousel::ringbus
