#include <algorithm>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"

namespace carousel::config {

namespace {

/// The keys of places where packets wait.
void check_places(const GraphNode& node, const std::string& key, const RuleBreach& breach) {
  const auto none = [&](bool differs, const char* name, const char* expected) {
    if (differs)
      breach(fmt::format("{}.{}", key, name),
             fmt::format("every node has room for all messages, and no packets wait there; expected {}, or "
                         "topology.trace: packets",
                         expected));
  };
  none(node.buffers.has_value(), "buffers", "auto");
  none(node.forward != Forward::kHead, "forward", "head");
  none(node.credit_cycles != 0, "credit_cycles", "0");
}

}  // namespace

void check_stacks(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  if (c.shape != TopologyShape::kGraph || c.trace != Tracing::kStacks) return;
  if (config.workload.kind == WorkloadConfig::Kind::kTraffic)
    breach("topology.trace", "synthetic traffic goes in packets; expected packets, found stacks");
  for (std::size_t i = 0; i < c.nodes.size(); ++i) {
    const GraphNode& node = c.nodes[i];
    const std::string key = fmt::format("topology.nodes.{}", i);
    if (node.kind == GraphNodeKind::kPacketProcess || node.kind == GraphNodeKind::kBus)
      breach(
          key + ".kind",
          fmt::format("resources that trace their own rays have no packets, which are all that a {} is for; expected "
                      "another kind, or topology.trace: packets; found {}",
                      enum_name(node.kind), enum_name(node.kind)));
    else
      check_places(node, key, breach);
  }
  for (std::size_t i = 0; i < c.links.size(); ++i)
    if (std::ranges::count(c.links[i].carries, Carried::kPackets) > 0)
      breach(fmt::format("topology.links.{}.carries", i),
             "resources that trace their own rays send no packets; expected shapes, new_rays or completed_rays, or "
             "topology.trace: packets; found packets");
}

}  // namespace carousel::config
