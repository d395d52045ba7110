#include "core/config/graph/clocks.h"

#include <algorithm>

namespace carousel::config {

std::optional<std::int64_t> ClockTable::of(std::string_view name) const {
  if (name == "core") return core_mhz;
  if (name == "noc") return clocks.noc.value_or(core_mhz);
  const auto found = clocks.others.find(std::string(name));
  return found == clocks.others.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> ClockTable::names() const {
  std::vector<std::string> out{"core", "noc"};
  for (const auto& [name, mhz] : clocks.others) out.push_back(name);
  return out;
}

void name_clocks(TopologyConfig& topology, const ClockTable& clocks, bool traffic) {
  topology.core_mhz = clocks.core_mhz;
  topology.synchroniser_cycles = clocks.clocks.synchroniser_cycles;
  if (topology.shape != TopologyShape::kGraph) return;
  const auto resolve = [&](const std::string& name, std::string_view otherwise) {
    const std::int64_t mhz = clocks.of(name.empty() ? otherwise : std::string_view(name)).value_or(clocks.core_mhz);
    return mhz == clocks.core_mhz ? 0 : mhz;  // equal clocks are one
  };
  for (GraphNode& node : topology.nodes)
    node.mhz = resolve(node.clock, traffic || node.kind == GraphNodeKind::kRouter ? "noc" : "core");
  for (GraphLink& link : topology.links) link.mhz = resolve(link.clock, "noc");
}

std::vector<UsedClock> used_clocks(const TopologyConfig& topology, std::int64_t core_mhz) {
  std::vector<UsedClock> out{{"core", core_mhz}};
  if (topology.shape != TopologyShape::kGraph) return out;
  const auto add = [&](const std::string& name, std::int64_t mhz) {
    if (mhz == 0 || std::ranges::any_of(out, [&](const UsedClock& one) { return one.mhz == mhz; })) return;
    out.push_back({name.empty() ? "noc" : name, mhz});
  };
  for (const GraphNode& node : topology.nodes) add(node.clock, node.mhz);
  for (const GraphLink& link : topology.links) add(link.clock, link.mhz);
  return out;
}

}  // namespace carousel::config
