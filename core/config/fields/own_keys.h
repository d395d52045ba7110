#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/config/fields/field.h"

namespace carousel {

/// The numbers in which a resource may differ from the others, beside its testers: a member for each row of kOwnKeys.
/// Absent: as in the whole machine.
struct OwnKeys {
  std::optional<std::int64_t> slots_per_resource{}, reads_per_cycle{}, ids_per_cycle{}, ready{}, capacity{},
      sort_ids_per_cycle{}, partial_after_cycles{}, fetch_ahead{}, shape_buffer_kib{}, l1_kib{}, l1_ways{},
      l1_lines_per_cycle{}, l1_mshrs{}, l1_latency_cycles{};

  friend bool operator==(const OwnKeys&, const OwnKeys&) = default;
};

namespace config {

/// A row of the list of what a resource may have of its own.
template <class Of>
struct OwnKey {
  std::string_view name;                      ///< in an override, or at a node of a graph
  const char* path;                           ///< the key for the whole machine
  std::optional<std::int64_t> OwnKeys::*own;  ///< its value
  Of of;                                      ///< the value of the whole machine, of what has the sections
  IntRange range;                             ///< as that of the whole machine, but for sizes of nothing
  const char *unit, *meaning;
  const char* part = nullptr;  ///< class that the search for the bottleneck relaxes; null: none
  Better better = Better::kTwice;
  Relaxed relaxed = {};
};

// Clang 14 deduces no arguments of aggregates by itself.
template <class Of>
OwnKey(std::string_view, const char*, std::optional<std::int64_t> OwnKeys::*, Of, IntRange, const char*, const char*,
       const char* = nullptr, Better = Better::kTwice, Relaxed = {}) -> OwnKey<Of>;

/// The one list of what may differ from resource to resource, beside testers. Reader, schema, pages, messages, rules
/// and machine go through it; core/config/own_sections.h applies it.
inline constexpr std::tuple kOwnKeys{
    OwnKey{"slots_per_resource", "rays.slots_per_resource", &OwnKeys::slots_per_resource,
           [](auto& s) -> decltype(auto) { return (s.rays.slots_per_resource); }, IntRange{1, kMaxSlots}, "rays",
           "The number of rays that it stores at a time.", "ray_slots", Better::kTwice,
           Relaxed{.times = kStorageTimes}},
    OwnKey{"reads_per_cycle", "rays.reads_per_cycle", &OwnKeys::reads_per_cycle,
           [](auto& s) -> decltype(auto) { return (s.rays.reads_per_cycle); }, IntRange{0, 1024}, "records/cycle",
           "The rays or bundles whose data its testers read from its store.", "ray_reads"},
    OwnKey{"ids_per_cycle", "packets.ids_per_cycle", &OwnKeys::ids_per_cycle,
           [](auto& s) -> decltype(auto) { return (s.packets.ids_per_cycle); }, IntRange{1, 1024}, "ray IDs/cycle",
           "The number of a packet's ray IDs that it reads.", "dispatch"},
    OwnKey{"ready", "collections.ready", &OwnKeys::ready,
           [](auto& s) -> decltype(auto) { return (s.collections.ready); }, IntRange{1, 65536}, "rays",
           "The number of rays that make one of its collections ready."},
    OwnKey{"capacity", "collections.capacity", &OwnKeys::capacity,
           [](auto& s) -> decltype(auto) { return (s.collections.capacity); }, IntRange{1, 1 << 30}, "ray IDs",
           "Its storage for collections.", "collection_storage", Better::kTwice, Relaxed{.times = kStorageTimes}},
    OwnKey{"sort_ids_per_cycle", "collections.sort_ids_per_cycle", &OwnKeys::sort_ids_per_cycle,
           [](auto& s) -> decltype(auto) { return (s.collections.sort_ids_per_cycle); }, IntRange{0, 1024},
           "ray IDs/cycle", "The ray IDs that it sorts by what comes next, and appends to collections.", "sorting"},
    OwnKey{"partial_after_cycles", "collections.partial_after_cycles", &OwnKeys::partial_after_cycles,
           [](auto& s) -> decltype(auto) { return (s.collections.partial_after_cycles); }, IntRange{1, 1'000'000'000},
           "cycles", "The time that one of its collections waits to be filled, with partial: after."},
    OwnKey{"fetch_ahead", "memory.fetch_ahead", &OwnKeys::fetch_ahead,
           [](auto& s) -> decltype(auto) { return (s.memory.fetch_ahead); }, IntRange{0, 64}, "packets",
           "The number of its packets whose shapes are fetched in advance.", "fetch_ahead", Better::kTwiceOrOne},
    OwnKey{"shape_buffer_kib", "memory.shape_buffer_kib", &OwnKeys::shape_buffer_kib,
           [](auto& s) -> decltype(auto) { return (s.memory.shape_buffer_kib); }, IntRange{1, 1 << 20}, "KiB",
           "The shape data that it holds.", "shape_buffer", Better::kTwice, Relaxed{.keeps_shapes = true}},
    OwnKey{"l1_kib", "memory.l1_kib", &OwnKeys::l1_kib, [](auto& s) -> decltype(auto) { return (s.memory.l1_kib); },
           IntRange{1, 1 << 20}, "KiB", "The size of its own cache, where memory.l1_kib gives all resources one.",
           "l1_size", Better::kTwice, Relaxed{.keeps_shapes = true}},
    OwnKey{"l1_ways", "memory.l1_ways", &OwnKeys::l1_ways, [](auto& s) -> decltype(auto) { return (s.memory.l1_ways); },
           IntRange{1, 64}, "ways", "The associativity of its own cache."},
    OwnKey{"l1_lines_per_cycle", "memory.l1_lines_per_cycle", &OwnKeys::l1_lines_per_cycle,
           [](auto& s) -> decltype(auto) { return (s.memory.l1_lines_per_cycle); }, IntRange{1, 64}, "lines/cycle",
           "The number of lines that its own cache looks up in a cycle.", "l1_port"},
    OwnKey{"l1_mshrs", "memory.l1_mshrs", &OwnKeys::l1_mshrs,
           [](auto& s) -> decltype(auto) { return (s.memory.l1_mshrs); }, IntRange{0, 65536}, "lines",
           "The lines that its own cache can have on their way; 0 is no bound.", "l1_mshrs"},
    OwnKey{"l1_latency_cycles", "memory.l1_latency_cycles", &OwnKeys::l1_latency_cycles,
           [](auto& s) -> decltype(auto) { return (s.memory.l1_latency_cycles); }, kCycles, "cycles",
           "The time of a hit in its own cache."},
};

/// Calls `body` with each row.
template <class Body>
constexpr void for_each_own_key(const Body& body) {
  std::apply([&](const auto&... row) { (body(row), ...); }, kOwnKeys);
}

/// Why a resource has no such key of its own, by the beginning of the path for the whole machine; the longest one that
/// fits counts.
struct SharedKey {
  std::string_view path, why;
};
inline constexpr SharedKey kSharedKeys[] = {
    {"rays.placement", "ray control places the rays of all resources by one rule"},
    {"rays.banks", "rays.banks and rays.reads_per_cycle exclude each other for the whole machine"},
    {"rays", "the rays of all resources come from one place"},
    {"packets", "the resources pass packets on to one another, so these have one form"},
    {"collections", "packets that one resource makes are tested by others, and retired by the same rule"},
    {"bundles", "a packet brings bundles to other resources than those that made them"},
    {"bvh", "there is one structure"},
    {"accuracy", "a hit is the same wherever it is found"},
    {"cull_planes", "they belong to the one structure"},
    {"memory.l2", "an L2 serves several resources"},
    {"memory.dram", "the memory serves all resources"},
    {"memory", "caches and memory have one kind of line, and of request, for all resources"},
    {"shading", "the workers shade the rays of all resources"},
    {"faults", "faults.resource names its resource"},
    {"image", "the picture is that of all resources"},
    {"engine", "one engine runs all resources"},
    {"energy", "a process makes all resources"},
    {"area", "a process makes all resources"},
    {"topology", "it describes the network"},
    {"", "the resources share it"},
};

/// The reason, for the path of a key of the whole machine.
constexpr std::string_view shared_because(std::string_view path) {
  const SharedKey* best = nullptr;
  for (const SharedKey& row : kSharedKeys)
    if (path.substr(0, row.path.size()) == row.path && (best == nullptr || row.path.size() > best->path.size()))
      best = &row;
  return best->why;
}

template <class V>
void describe(V& v, OwnKeys& c) {
  for_each_own_key([&](const auto& row) {
    const auto said = v.own_key(row, c.*row.own);
    if (row.part != nullptr) said.relax(row.part, row.better, row.relaxed);
  });
}

}  // namespace config
}  // namespace carousel
