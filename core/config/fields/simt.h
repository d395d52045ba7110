#pragma once

#include <cstdint>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

/// Rays of a resource in warps, as the units of a GPU take them.
struct SimtConfig {
  std::int64_t warp = 0;  ///< 0: rays go by themselves
  std::int64_t warps = 4;
  enum class Step { kWarp, kLane } step = Step::kWarp;
  std::int64_t wait_cycles = 64;
  std::int64_t lines_per_cycle = 1;
  std::int64_t stack_entries = 8;
  enum class Compaction { kNone, kRepack } compaction = Compaction::kNone;
  std::int64_t repack_rays_per_cycle = 8;
  enum class IdleLanes { kWait, kHelp } idle_lanes = IdleLanes::kWait;
};

template <>
inline constexpr auto kEnumNames<SimtConfig::Step> = [] {
  using enum SimtConfig::Step;
  return names<SimtConfig::Step>({{kWarp, "warp"}, {kLane, "lane"}});
}();

template <>
inline constexpr auto kEnumNames<SimtConfig::Compaction> = [] {
  using enum SimtConfig::Compaction;
  return names<SimtConfig::Compaction>({{kNone, "none"}, {kRepack, "repack"}});
}();

template <>
inline constexpr auto kEnumNames<SimtConfig::IdleLanes> = [] {
  using enum SimtConfig::IdleLanes;
  return names<SimtConfig::IdleLanes>({{kWait, "wait"}, {kHelp, "help"}});
}();

namespace config {

inline constexpr std::int64_t kMostLanes = 64;

template <class V>
void describe(V& v, SimtConfig& c) {
  v.field("warp", c.warp, IntRange{0, kMostLanes}, "rays",
          "The lanes of a warp. With 0 there are no warps: rays go by themselves.")
      .only(EngineKind::kCycle, "clock for warps");
  v.field("warps", c.warps, IntRange{1, 1024}, "warps", "The warps that a resource has under way at once.")
      .relax("ray_slots", Better::kTwice, Relaxed{.times = kStorageTimes}, c.warp > 0);
  v.choice("step", c.step,
           "The lanes of a warp take their next nodes together, when the slowest has been tested, or each when it has "
           "been tested itself.");
  v.field("wait_cycles", c.wait_cycles, IntRange{1, 1'000'000}, "cycles",
          "The time for which rays wait for others to fill their warp. Then it begins with empty lanes.");
  v.field("lines_per_cycle", c.lines_per_cycle, IntRange{1, 64}, "lines/cycle",
          "The lines of shape data that a resource reads for its warps. A line is read once for all lanes that ask for "
          "it together.")
      .relax("warp_reads", Better::kTwice, Relaxed{}, c.warp > 0);
  v.field("stack_entries", c.stack_entries, IntRange{1, 256}, "nodes",
          "The nodes that the registers of a ray's stack hold. Older ones are spilled to memory and read back, half of "
          "this number at a time.")
      .relax("stack_registers", Better::kTwice, Relaxed{.times = kStorageTimes}, c.warp > 0);
  v.choice("compaction", c.compaction,
           "A warp keeps its rays until the slowest has ended; or rays leave it after each step, and those whose next "
           "step is of one kind, at a node or at a leaf, are packed into new warps.");
  v.field("repack_rays_per_cycle", c.repack_rays_per_cycle, IntRange{1, 1024}, "rays/cycle",
          "The rays that are packed into warps.")
      .relax("packing", Better::kTwice, Relaxed{}, c.warp > 0);
  v.choice(
      "idle_lanes", c.idle_lanes,
      "Lanes whose rays have ended wait; or they help, and take nodes from the stacks of other rays of their warp.");
}

}  // namespace config
}  // namespace carousel
