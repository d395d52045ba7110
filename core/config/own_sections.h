#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/config/config.h"

namespace carousel {

/// The sections of the configuration that a resource follows, with what differs in it.
struct OwnSections {
  RaysConfig rays;
  PacketsConfig packets;
  CollectionsConfig collections;
  MemoryConfig memory;
  TestersConfig testers;
};

/// The sections of one resource. Only the cycle engine has resources that differ, but for packet processes, which store
/// no rays.
inline OwnSections own_sections(const Config& c, std::int64_t resource) {
  OwnSections out{c.rays, c.packets, c.collections, c.memory, c.testers};
  if (resource >= ray_owners(c.topology)) out.rays.slots_per_resource = 0;
  if (c.engine.kind != EngineKind::kCycle) return out;
  for_each_own(c.topology, [&](const OwnOf& one) {
    if (!one.is_about(resource)) return;
    if (one.testers != nullptr) out.testers = *one.testers;
    config::for_each_own_key([&](const auto& row) {
      if (const auto own = one.keys->*row.own) row.of(out) = *own;
    });
  });
  return out;
}

/// The same with nothing in place of what the resource does not have: a packet process that serves resources has
/// collections and no testers, buffers and caches, and these resources have no collections.
inline OwnSections built_sections(const Config& c, std::int64_t resource) {
  OwnSections out = own_sections(c, resource);
  if (managers_of(c.topology) == 0) return out;
  if (resource < ray_owners(c.topology)) {
    out.collections.capacity = 0;
    return out;
  }
  for (auto [kind, units] : out.testers.units) units.units = 0;
  out.memory.shape_buffer_kib = out.memory.l1_kib = 0;
  return out;
}

/// The sum of a number over all resources. `of`: of the sections of one, as it is built.
template <class Of>
std::int64_t sum_of_resources(const Config& c, const Of& of) {
  if (!has_own(c.topology) && managers_of(c.topology) == 0) {
    const OwnSections all = own_sections(c, 0);
    return c.topology.resources * of(all);
  }
  std::int64_t sum = 0;
  for (std::int64_t r = 0; r < c.topology.resources; ++r) sum += of(built_sections(c, r));
  return sum;
}

/// The largest of them.
template <class Of>
std::int64_t most_of_resources(const Config& c, const Of& of) {
  std::int64_t most = of(own_sections(c, 0));
  for (std::int64_t r = 1; r < c.topology.resources && has_own(c.topology); ++r)
    most = std::max(most, of(own_sections(c, r)));
  return most;
}

inline std::int64_t all_slots(const Config& c) {
  return sum_of_resources(c, [](const OwnSections& one) { return one.rays.slots_per_resource; });
}

}  // namespace carousel
