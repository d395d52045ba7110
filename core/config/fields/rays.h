#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"
#include "core/config/fields/queue_kind.h"

namespace carousel {

enum class Placement { kBalanced, kRoundRobin, kFirstTaker, kAddressed };
template <>
inline constexpr auto kEnumNames<Placement> = [] {
  using enum Placement;
  return names<Placement>(
      {{kBalanced, "balanced"}, {kRoundRobin, "round_robin"}, {kFirstTaker, "first_taker"}, {kAddressed, "addressed"}});
}();

template <>
inline constexpr std::string_view kAddedAs<Placement> = "placement";

/// The order in which rays enter the native engine's machine.
enum class RaySort { kNone, kCells };
template <>
inline constexpr auto kEnumNames<RaySort> = [] {
  using enum RaySort;
  return names<RaySort>({{kNone, "none"}, {kCells, "cells"}});
}();

enum class Query { kClosest, kAny, kAll };
template <>
inline constexpr auto kEnumNames<Query> = [] {
  using enum Query;
  return names<Query>({{kClosest, "closest"}, {kAny, "any"}, {kAll, "all"}});
}();

/// These keys say what the rays look for, and how those that look for several hits find them.
struct QueryConfig {
  Query hits = Query::kClosest;
  std::int64_t nearest = 0;            ///< 0: the closest alone
  std::optional<std::int64_t> buffer;  ///< absent: as many as `nearest`, and 64 at most
  enum class Rounds { kRestart, kResume } rounds = Rounds::kRestart;
  std::int64_t response_steps = 8, harmonic_steps = 1;

  static constexpr std::int64_t kMostBuffered = 64;

  /// The hits that a ray's buffer holds at once.
  std::int64_t buffered() const { return std::min(buffer.value_or(kMostBuffered), nearest); }
  /// True if one pass of the tree does not find them all.
  bool in_rounds() const { return buffered() < nearest; }
  friend bool operator==(const QueryConfig&, const QueryConfig&) = default;
};

template <>
inline constexpr auto kEnumNames<QueryConfig::Rounds> = [] {
  using enum QueryConfig::Rounds;
  return names<QueryConfig::Rounds>({{kRestart, "restart"}, {kResume, "resume"}});
}();

struct RaysConfig {
  std::int64_t slots_per_resource = 1024;
  Placement placement = Placement::kBalanced;
  RaySort sort = RaySort::kNone;
  std::int64_t reads_per_cycle = 0, banks = 0;
  QueryConfig query;
  std::int64_t hits_per_ray = 1024;
  RayQueueConfig queue{QueueKind::kMpmcRing, 256};
};

namespace config {

inline constexpr std::int64_t kMostNearest = 65536;

template <class V>
void describe(V& v, QueryConfig& c) {
  v.choice("hits", c.hits, "The hits of a file's rays that are looked for: the closest, any one, or all.");
  v.field(
      "nearest", c.nearest, IntRange{0, kMostNearest}, "hits",
      "The nearest hits that a ray looks for which would look for the closest one. With 0 it finds that one alone.");
  v.field_or_auto(
      "buffer", c.buffer, IntRange{1, QueryConfig::kMostBuffered}, "hits",
      "The hits that the sorted buffer beside a ray's record holds. With fewer than nearest a ray finds its "
      "hits in rounds. auto: as many as nearest, and 64 at most.");
  v.choice("rounds", c.rounds,
           "A further round begins at the root again and leaves out the hits that have been found; or it goes on with "
           "the nodes and hits that the rounds before have set aside.");
  v.field(
      "response_steps", c.response_steps, IntRange{0, 1024}, "steps",
      "The steps of a testers.hit_buffer unit for the greatest response of a Gaussian along a ray, and for its share "
      "in the ray's light.");
  v.field("harmonic_steps", c.harmonic_steps, IntRange{0, 64}, "steps",
          "The steps of such a unit for each coefficient of harmonics above degree 0, in three channels, of the colour "
          "of a Gaussian that the ray meets. A direction that the Gaussian's node turns takes those of three.");
}

template <class V>
void describe(V& v, RaysConfig& c) {
  v.field("slots_per_resource", c.slots_per_resource, IntRange{1, kMaxSlots}, "rays",
          "The number of rays that a resource stores at a time.")
      .relax("ray_slots", Better::kTwice, Relaxed{.times = kStorageTimes});
  v.choice("placement", c.placement, "The rule that chooses the resource of a new ray.");
  v.choice("sort", c.sort,
           "The order in which new rays get slots. With none it is that in which they were made. With cells a shader "
           "worker waits until half of the slots are free, and brings rays that start near one another and run into "
           "the same octant together. Hits are the same.")
      .only(EngineKind::kNative, "real queues");
  v.field("reads_per_cycle", c.reads_per_cycle, IntRange{0, 1024}, "records/cycle",
          "The number of rays or bundles whose data the testers of a resource read from its store. With 0 there is no "
          "limit.")
      .relax("ray_reads", Better::kTwice);
  v.field(
       "banks", c.banks, IntRange{0, 256}, "banks",
       "The banks of a resource's ray store, which hold its slots in turn. Each has a port to the box units and one to "
       "the units for primitives, which read one record a cycle. With 0 rays.reads_per_cycle is the limit.")
      .relax("ray_banks", Better::kTwice)
      .only(EngineKind::kCycle, "simulated ray memory");
  v.section_or_choice("query", c.query, "The hits that rays look for. A word stands for {hits: WORD}.");
  v.field("hits_per_ray", c.hits_per_ray, IntRange{1, 1 << 24}, "hits",
          "The largest number of hits of a ray with query: all. A ray with more ends the run with an error.");
  v.choice("queue", c.queue.kind,
           "The queues that bring groups of new rays to the resources that issue them in the native engine.")
      .only(EngineKind::kNative, "real queues");
  v.field("queue_depth", c.queue.depth, IntRange{1, 65536}, "groups",
          "The number of groups of new rays, of packets.rays each, that one of these queues holds.")
      .only(EngineKind::kNative, "real queues");
}

}  // namespace config
}  // namespace carousel
