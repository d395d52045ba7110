#pragma once

#include <cstdint>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"
#include "core/types/unit_kind.h"

namespace carousel {

/// The units of one kind that a resource has.
struct TesterUnits {
  std::int64_t units = 1;
  std::int64_t interval_cycles = 1;
  std::int64_t latency_cycles = 4;

  friend bool operator==(const TesterUnits&, const TesterUnits&) = default;
};

constexpr PerUnit<TesterUnits> default_tester_units() {
  PerUnit<TesterUnits> out;
  for (const UnitKindRow& row : kUnitKinds) out[row.kind] = {row.units, row.interval_cycles, row.latency_cycles};
  return out;
}

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
  enum class Prefetch { kNone, kTreelet } prefetch = Prefetch::kNone;
  std::int64_t prefetch_rays = 16;
  std::int64_t vote_cycles = 16;

  friend bool operator==(const SimtConfig&, const SimtConfig&) = default;
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

/// The rule by which a resource chooses among packets that wait. Plugins add others (core/types/dispatch_rule.h).
enum class Dispatch { kReady };
template <>
inline constexpr auto kEnumNames<Dispatch> = [] {
  using enum Dispatch;
  return names<Dispatch>({{kReady, "ready"}});
}();
template <>
inline constexpr std::string_view kAddedAs<Dispatch> = "dispatch";
template <>
inline constexpr auto kEnumNames<SimtConfig::Prefetch> = [] {
  using enum SimtConfig::Prefetch;
  return names<SimtConfig::Prefetch>({{kNone, "none"}, {kTreelet, "treelet"}});
}();

struct TestersConfig {
  PerUnit<TesterUnits> units = default_tester_units();
  struct Simd {
    std::int64_t lanes = 1;
    enum class Map { kRays, kShapes } map = Map::kRays;
    std::int64_t reformat_cycles = 1;

    friend bool operator==(const Simd&, const Simd&) = default;
  } simd;
  struct Distributor {
    std::int64_t testers = 8;
    std::int64_t ids_per_cycle = 8;
    std::int64_t queue = 8;
    std::int64_t out_of_order = 1;
    enum class Stragglers { kWait, kForward } stragglers = Stragglers::kWait;
    std::int64_t results_per_cycle = 8;
    std::int64_t results = 8;

    friend bool operator==(const Distributor&, const Distributor&) = default;
  } distributor;
  SimtConfig simt;
  std::int64_t stack_entries = 0;  ///< of a ray by itself; 0: all stay
  std::int64_t contexts = 16;
  std::int64_t window = 1;
  Dispatch dispatch = Dispatch::kReady;
  enum class OwnRays { kBefore, kAfter } own_rays = OwnRays::kBefore;
  enum class AnyHit { kInline, kShader } any_hit = AnyHit::kInline;
  enum class BundleBlocks { kSeparate, kPairs, kShared } bundle_blocks = BundleBlocks::kSeparate;

  friend bool operator==(const TestersConfig&, const TestersConfig&) = default;
};

template <>
inline constexpr auto kEnumNames<TestersConfig::Simd::Map> = [] {
  using enum TestersConfig::Simd::Map;
  return names<TestersConfig::Simd::Map>({{kRays, "rays"}, {kShapes, "shapes"}});
}();

template <>
inline constexpr auto kEnumNames<TestersConfig::Distributor::Stragglers> = [] {
  using enum TestersConfig::Distributor::Stragglers;
  return names<TestersConfig::Distributor::Stragglers>({{kWait, "wait"}, {kForward, "forward"}});
}();

template <>
inline constexpr auto kEnumNames<TestersConfig::OwnRays> = [] {
  using enum TestersConfig::OwnRays;
  return names<TestersConfig::OwnRays>({{kBefore, "before"}, {kAfter, "after"}});
}();

template <>
inline constexpr auto kEnumNames<TestersConfig::AnyHit> = [] {
  using enum TestersConfig::AnyHit;
  return names<TestersConfig::AnyHit>({{kInline, "inline"}, {kShader, "shader"}});
}();

template <>
inline constexpr auto kEnumNames<TestersConfig::BundleBlocks> = [] {
  using enum TestersConfig::BundleBlocks;
  return names<TestersConfig::BundleBlocks>({{kSeparate, "separate"}, {kPairs, "pairs"}, {kShared, "shared"}});
}();

namespace config {

template <class V>
void describe(V& v, TesterUnits& c) {
  v.field("units", c.units, IntRange{1, 1024}, "units", "The number of units of this kind in a resource.");
  v.field("interval_cycles", c.interval_cycles, kCycles, "cycles", "The time between two tests that a unit starts.");
  v.field("latency_cycles", c.latency_cycles, kCycles, "cycles", "The time from the start of a test to its result.")
      .relax("test_latency", Better::kHalf, Relaxed{.times = 0});
}

template <class V>
void describe(V& v, TestersConfig::Simd& c) {
  v.field("lanes", c.lanes, IntRange{1, 64}, "lanes",
          "The number of tests that a unit starts side by side. With 1 it starts each test by itself.")
      .relax("cells", Better::kTwice);
  v.choice("map", c.map, "The lanes hold rays that are tested against one shape, or shapes tested against one ray.");
  v.field(
      "reformat_cycles", c.reformat_cycles, IntRange{0, 1000}, "cycles",
      "The time to bring the results of a packet's lanes into the order of its rays and shapes, with several lanes.");
}

template <class V>
void describe(V& v, TestersConfig::Distributor& c) {
  v.field("testers", c.testers, IntRange{1, 1024}, "testers",
          "The number of testers. Each has the units of `testers`, tests one ray at a time, and has its share of ray "
          "memory: the slots that are equal modulo this number.")
      .relax("distributed_testers", Better::kTwice);
  v.field("ids_per_cycle", c.ids_per_cycle, IntRange{1, 1024}, "IDs/cycle",
          "The ray IDs that the distributor hands to the testers.")
      .relax("handing_out", Better::kTwice);
  v.field("queue", c.queue, IntRange{1, 1024}, "IDs", "The number of ray IDs that wait at a tester.")
      .relax("tester_queues", Better::kTwice);
  v.field(
       "out_of_order", c.out_of_order, IntRange{0, 63}, "packets",
       "The number of packets that testers may begin while an older one has not been tested. With 0 testers that are "
       "done with a packet stand still until all are.")
      .relax("out_of_order", Better::kTwiceOrOne);
  v.choice("stragglers", c.stragglers,
           "The results of a packet go on together when the last is there, or each when it is there.")
      .relax("stragglers", TestersConfig::Distributor::Stragglers::kForward, Relaxed{.times = 0});
  v.field("results_per_cycle", c.results_per_cycle, IntRange{1, 1024}, "results/cycle",
          "The results that the decision point takes from the testers, those of older packets first.")
      .relax("decision_point", Better::kTwice);
  v.field("results", c.results, IntRange{1, 1024}, "results",
          "The number of results of a tester that wait for the decision point.")
      .relax("tester_queues", Better::kTwice);
}

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
  v.choice(
      "prefetch", c.prefetch,
      "Lines of shape data are read when a lane asks for them; or with treelet, while the port is idle, also those "
      "of the treelet in which the next nodes of most rays in warps are. Needs bvh.treelets.bytes.");
  v.field("prefetch_rays", c.prefetch_rays, IntRange{1, 1 << 16}, "rays",
          "The least number of rays in warps whose next node is in a treelet that is prefetched.");
  v.field("vote_cycles", c.vote_cycles, IntRange{1, 10'000}, "cycles",
          "The time that the prefetcher takes to find the treelet of the most rays.");
}

template <class V>
void describe(V& v, TestersConfig& c) {
  for (const UnitKindRow& row : kUnitKinds)
    v.section_or_number(row.key, c.units[row.kind], row.meaning).relax(row.work, Better::kTwice, Relaxed{.times = 0});
  v.section("simd", c.simd, "The lanes of the units.");
  v.section("distributor", c.distributor, "Testers behind a distributor, with topology.form: distributor.");
  v.section("simt", c.simt, "Warps of rays, with topology.shape: independent.");
  v.field("stack_entries", c.stack_entries, IntRange{0, 256}, "nodes",
          "With topology.shape: independent and without warps, the nodes that a resource's registers hold of a ray's "
          "stack. Older ones are spilled to memory and read back, half of this number at a time. With 0 all have room.")
      .only(EngineKind::kCycle, "clock for spilled stacks")
      .relax("stack_registers", Better::kTwice, Relaxed{.times = kStorageTimes}, c.stack_entries > 0);
  v.field("contexts", c.contexts, IntRange{1, 64}, "packets", "The number of packets that a resource tests at once.")
      .relax("contexts", Better::kTwice);
  v.field("window", c.window, IntRange{1, 64}, "packets",
          "The number of packets at the front of a resource's input queue among which it takes the first that can go "
          "on and whose shapes are there.")
      .only(EngineKind::kCycle, "choice among packets that have arrived");
  v.choice("dispatch", c.dispatch,
           "The packet that a resource takes of those in its window: ready, the first that can go on and whose shapes "
           "are there, or else the first that can go on; or the choice of a plugin.");
  v.choice("own_rays", c.own_rays,
           "The issuer of a packet tests its own rays before the packet leaves, or after it has come back.");
  v.choice("any_hit", c.any_hit,
           "The unit that meets a non-opaque primitive decides at once if it is hit, or a shader worker decides.")
      .only(EngineKind::kCycle, "any-hit calls by shader workers", TestersConfig::AnyHit::kShader);
  v.choice(
       "bundle_blocks", c.bundle_blocks,
       "A bundle unit does one test of a bundle at a time; or it is a pair of blocks that does both tests of a box at "
       "once, with bundles.order: parallel; or the box units test bundles as well.")
      .only(EngineKind::kCycle, "clock for bundle units");
}

}  // namespace config
}  // namespace carousel
