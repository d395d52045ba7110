#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "core/types/unit_kind.h"

namespace carousel::report {

/// A group for each class of parts: where a verdict cannot tell classes of one group apart, it names the group. Units
/// (kUnitKinds) are testers.
inline constexpr auto kPartGroups = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"memory_bandwidth", "memory"},
    {"memory_latency", "memory"},
    {"memory_tlb", "memory"},
    {"dram_queue", "memory"},
    {"l1_size", "memory"},
    {"l1_port", "memory"},
    {"l1_mshrs", "memory"},
    {"l2_size", "memory"},
    {"l2_port", "memory"},
    {"l2_mshrs", "memory"},
    {"shape_buffer", "memory"},
    {"fetch_ahead", "memory"},
    {"prefetch", "memory"},
    {"prefetch_streams", "memory"},
    {"warp_reads", "memory"},
    {"contexts", "testers"},
    {"test_latency", "testers"},
    {"dispatch", "testers"},
    {"issue_rule", "testers"},
    {"sorting", "testers"},
    {"cells", "testers"},
    {"distributed_testers", "testers"},
    {"handing_out", "testers"},
    {"tester_queues", "testers"},
    {"out_of_order", "testers"},
    {"decision_point", "testers"},
    {"bundles_open", "testers"},
    {"bundle_builder", "testers"},
    {"packing", "testers"},
    {"stragglers", "testers"},
    {"link_bandwidth", "transport"},
    {"link_latency", "transport"},
    {"ring_directions", "transport"},
    {"rings", "transport"},
    {"packets_in_flight", "transport"},
    {"shading", "shading"},
    {"shading_data_cache", "shading"},
    {"shading_tlb", "shading"},
    {"shading_registers", "shading"},
    {"shading_lanes", "shading"},
    {"shading_order", "shading"},
    {"shading_sorter", "shading"},
    {"ray_slots", "room for rays"},
    {"ray_reads", "room for rays"},
    {"ray_banks", "room for rays"},
    {"collection_storage", "room for rays"},
    {"stack_registers", "room for rays"},
});

/// Empty for a class that belongs to none.
constexpr std::string_view group_of(std::string_view part) {
  for (const UnitKindRow& row : kUnitKinds)
    if (row.work == part) return "testers";
  const auto* const at =
      std::find_if(kPartGroups.begin(), kPartGroups.end(), [&](const auto& row) { return row.first == part; });
  return at == kPartGroups.end() ? std::string_view{} : at->second;
}

}  // namespace carousel::report
