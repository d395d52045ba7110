#pragma once

#include <vector>

#include "core/statistics/distributor_counts.h"
#include "core/statistics/warp_counts.h"
#include "core/types/unit_kind.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// Cycles of a group of equal units; they add up to the run.
struct UnitCycles {
  std::uint64_t busy = 0, other_units = 0, latency = 0, passing = 0, memory = 0, link = 0, credits = 0, storage = 0,
                shading = 0, idle = 0;

  static constexpr auto counters() {
    using C = UnitCycles;
    return std::array{
        Counter{"busy", &C::busy, "cycles", "a test was started, or the units' interval kept one from starting"},
        Counter{"other_units", &C::other_units, "cycles",
                "a packet was in test, and other units worked or ray records were read"},
        Counter{"latency", &C::latency, "cycles",
                "a packet was in test, and all units waited for answers from their pipelines"},
        Counter{"passing", &C::passing, "cycles",
                "a packet was in test, and no test was under way: its ray IDs were read, or it passed without a test"},
        Counter{"memory", &C::memory, "cycles", "a packet waited for shape data"},
        Counter{"link", &C::link, "cycles", "a packet waited to leave"},
        Counter{"credits", &C::credits, "cycles", "no packet was free to issue with"},
        Counter{"storage", &C::storage, "cycles", "too few collection blocks were free"},
        Counter{"shading", &C::shading, "cycles", "the resource helped the shader workers"},
        Counter{"idle", &C::idle, "cycles", "there was nothing to test"},
    };
  }
};

/// The fraction of the units, or of their lanes, that had a test, of each kind; absent for kinds that made none.
struct LaneFill {
  PerUnit<std::optional<double>> kinds{};
};

template <class V>
void describe(V& v, const LaneFill& r) {
  for (const UnitKindRow& row : kUnitKinds) v.field(row.name, r.kinds[row.kind], "fraction", row.meaning);
}

/// The lanes of the rays of one bounce.
struct BounceLanes {
  std::uint64_t bounce = 0;
  LaneUse use{};
};

template <class V>
void describe(V& v, const BounceLanes& r) {
  v.field("bounce", r.bounce, "surfaces",
          "bounce of the rays; 0 is that of camera rays and of the shadow rays of what they hit");
  describe(v, r.use);
  v.field("fill", ratio(r.use.ray_cycles, r.use.lane_cycles), "fraction", "part of the lanes whose ray had not ended");
}

/// Rays in warps.
struct Warps {
  std::uint64_t lanes = 0;  ///< of a warp
  WarpCounts counts{};
  std::vector<BounceLanes> bounces{};
};

template <class V>
void describe(V& v, const Warps& r) {
  const auto fill = [&](std::uint64_t tested, std::uint64_t steps) { return ratio(tested, steps * r.lanes); };
  v.field("fill", ratio(r.counts.ray_cycles, r.counts.lane_cycles), "fraction",
          "part of the lanes whose ray had not ended, over the cycles of all warps");
  v.field("step_fill", fill(r.counts.tested, r.counts.steps), "fraction", "part of the lanes with a test, over steps");
  v.field("box_fill", fill(r.counts.box_tested, r.counts.box_steps), "fraction",
          "part of the lanes that tested a node, over steps in which one did");
  v.field("leaf_fill", fill(r.counts.leaf_tested, r.counts.leaf_steps), "fraction",
          "part of the lanes that tested a leaf, over steps in which one did");
  describe(v, r.counts);
  v.section("bounces", r.bounces, "the lanes by the bounce of their rays");
}

struct Units {
  PerUnit<UnitCycles> kinds{};
  LaneFill unit_fill{};
  std::optional<LaneFill> lane_fill{};
  RunFeatures features{};
  std::optional<UnitCycles> ray_reads{}, primitive_ray_reads{};
  std::optional<std::uint64_t> bank_conflicts{}, second_reads{};
  std::optional<DistributorCounts> distributor{};
  std::optional<Warps> warps{};
  std::uint64_t dispatch_busy = 0, dispatch_idle = 0;
};

template <class V>
void describe(V& v, const Units& r) {
  const auto kind = [&](const UnitKindRow& row) {
    if (row.shown == Shown::kAlways)
      v.section(row.name, r.kinds[row.kind], row.meaning);
    else
      v.section_if(r.features.show(row.shown), row.name, r.kinds[row.kind], row.meaning);
  };
  for (const UnitKindRow& row : kUnitKinds) kind(row);
  v.section("ray_reads", r.ray_reads,
            "the port of the ray store, with rays.reads_per_cycle; with rays.banks that of its banks to the box units");
  v.section("primitive_ray_reads", r.primitive_ray_reads,
            "with rays.banks, the port of the banks to the units for primitives");
  v.field("bank_conflicts", r.bank_conflicts, "cycles",
          "reading took longer than with the records evenly over the banks, with rays.banks; of both ports");
  v.field("second_reads", r.second_reads, "records",
          "with rays.banks, records that both ports read, for nodes that hold boxes and primitives");
  v.section(
      "distributor", r.distributor,
      "the testers behind a distributor, with topology.form: distributor; the cycles of units are the mean of the "
      "testers");
  v.section("warps", r.warps, "rays in warps, with testers.simt");
  v.section("unit_fill", r.unit_fill, "fraction of the units of a kind that had a test while any of them was busy");
  v.section("lane_fill", r.lane_fill, "fraction of the lanes that had a test, with testers.simd.lanes");
  v.field("dispatch_busy", r.dispatch_busy, "cycles", "the dispatch stage looked through the ray IDs of a packet");
  v.field("dispatch_idle", r.dispatch_idle, "cycles", "the dispatch stage did nothing");
}

}  // namespace carousel::report
