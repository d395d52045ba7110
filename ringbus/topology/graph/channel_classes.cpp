#include "ringbus/topology/graph/channel_classes.h"

#include <algorithm>

namespace carousel::ringbus {

namespace {

using config::Graph;

/// Calls `body(from, to)` with each pair of different resources.
template <class Body>
void for_each_pair(const Graph& graph, const Body& body) {
  for (std::uint32_t from = 0; from < graph.resources; ++from)
    for (std::uint32_t to = 0; to < graph.resources; ++to)
      if (from != to) body(from, to);
}

/// Links with which every circle has one at least.
std::vector<bool> choose_datelines(const Graph& graph, const Routes& routes) {
  const Dependencies waits = traffic_dependencies(graph, routes);
  std::vector<bool> chosen(graph.links.size());
  for (;;) {
    // Without those that are chosen, and without what leads into no circle.
    Dependencies rest(graph.links.size());
    for (std::uint32_t link = 0; link < graph.links.size(); ++link)
      for (const std::uint32_t next : waits.after(link))
        if (!chosen[link] && !chosen[next]) rest.add(link, next);
    const std::vector<bool> left = rest.on_circles();
    std::vector<std::uint64_t> before(graph.links.size()), after(graph.links.size());
    for (std::uint32_t link = 0; link < graph.links.size(); ++link)
      for (const std::uint32_t next : rest.after(link))
        if (left[link] && left[next]) {
          ++after[link];
          ++before[next];
        }
    std::uint32_t best = 0;
    for (std::uint32_t link = 1; link < graph.links.size(); ++link)
      if (before[link] * after[link] > before[best] * after[best]) best = link;
    if (graph.links.empty() || before[best] * after[best] == 0) return chosen;
    chosen[best] = true;
  }
}

}  // namespace

ChannelPlan plan_channels(const TopologyConfig& config, const Graph& graph, const Routes& routes) {
  ChannelPlan plan;
  plan.rule = config.channels == ChannelRule::kNone ? ChannelRule::kAny : config.channels;
  for (const Graph::Link& link : graph.links) {
    plan.channels.push_back(static_cast<std::uint32_t>(link.virtual_channels));
    plan.datelines.push_back(link.dateline);
  }
  if (plan.rule == ChannelRule::kAny) return plan;
  if (plan.rule == ChannelRule::kDateline && std::ranges::none_of(plan.datelines, [](bool one) { return one; }))
    plan.datelines = choose_datelines(graph, routes);
  for_each_pair(graph, [&](std::uint32_t from, std::uint32_t to) {
    std::uint32_t own = 0;
    bool first = true;
    routes.for_each_link(from, to, [&](std::uint32_t link) {
      own = first ? 0 : plan.after(own, link);
      first = false;
    });
    plan.classes = std::max(plan.classes, own + 1);
  });
  return plan;
}

ChannelDependencies channel_dependencies(const Graph& graph, const Routes& routes, const ChannelPlan& plan) {
  std::vector<std::uint32_t> first;
  ChannelDependencies out;
  for (std::uint32_t link = 0; link < graph.links.size(); ++link) {
    first.push_back(static_cast<std::uint32_t>(out.link_of.size()));
    for (std::uint32_t own = 0; own < plan.classes_of(link); ++own) {
      out.link_of.push_back(link);
      out.class_of.push_back(own);
    }
  }
  out.waits = Dependencies(out.link_of.size());
  for_each_pair(graph, [&](std::uint32_t from, std::uint32_t to) {
    std::uint32_t own = 0, before = Routes::kNone;
    routes.for_each_link(from, to, [&](std::uint32_t link) {
      if (before != Routes::kNone) own = plan.after(own, link);
      const std::uint32_t at = first[link] + plan.class_on(link, own);
      if (before != Routes::kNone) out.waits.add(before, at);
      before = at;
    });
  });
  return out;
}

}  // namespace carousel::ringbus
