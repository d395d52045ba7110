#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "core/config/load/network_rules.h"
#include "core/config/own_sections.h"

namespace carousel::config {

namespace {

/// The rules of numbers that a resource has of its own, each of which holds for the whole machine as well.
class OwnRules {
 public:
  OwnRules(const Config& config, const OwnOf& own, const RuleBreach& breach)
      : c(config), keys_(*own.keys), place_(own_place(own) + "."), breach_(breach) {
    for_each_own_key([&](const auto& row) {
      if (const auto value = keys_.*row.own) row.of(sections_) = *value;
    });
  }

  void check() {
    caches_are_there();
    if (keys_.reads_per_cycle && c.rays.banks > 0)
      breach_(place_ + "reads_per_cycle",
              fmt::format("each bank has a port of its own; expected auto, or rays.banks: 0; found {}",
                          *keys_.reads_per_cycle));
    const std::int64_t slots = sections_.rays.slots_per_resource;
    if (c.bundles.size > slots)
      breach_(place_ + "slots_per_resource",
              fmt::format("a bundle's rays live in one resource; expected at least bundles.size = {}, found {}",
                          c.bundles.size, slots));
    const auto bits = [](std::int64_t count) { return std::bit_width(static_cast<std::uint64_t>(count)); };
    if (c.bundles.size > 0 && bits(c.topology.resources - 1) + bits(2 * slots) > 32)
      breach_(
          place_ + "slots_per_resource",
          fmt::format("IDs of 32 bits name bundles as well; expected fewer slots than {}, or bundles.size: 0", slots));
  }

 private:
  void caches_are_there() {
    bool asks = false;
    for_each_own_key([&](const auto& row) {
      if (!row.name.starts_with("l1_") || !(keys_.*row.own)) return;
      asks = true;
      if (c.memory.l1_kib == 0)
        breach_(place_ + std::string(row.name),
                fmt::format("all resources have a cache of their own, or none; expected auto, or memory.l1_kib of at "
                            "least 1; found {}",
                            *(keys_.*row.own)));
    });
    if (!asks || c.memory.l1_kib == 0) return;
    const MemoryConfig& memory = sections_.memory;
    const std::int64_t lines = memory.l1_kib * 1024 / memory.line_bytes;
    const std::int64_t bytes = memory.l1_ways * memory.line_bytes, step = bytes / std::gcd(bytes, std::int64_t{1024});
    if (memory.l1_ways > lines)
      breach_(place_ + (keys_.l1_ways ? "l1_ways" : "l1_kib"),
              fmt::format("a cache of {} KiB has {} lines of {} bytes, and a set is no larger than the cache; found "
                          "{} ways",
                          memory.l1_kib, lines, memory.line_bytes, memory.l1_ways));
    else if (memory.l1_kib % step != 0)
      breach_(place_ + (keys_.l1_kib ? "l1_kib" : "l1_ways"),
              fmt::format("a cache has whole sets, of {} lines of {} bytes; expected a multiple of {} KiB, found {}",
                          memory.l1_ways, memory.line_bytes, step, memory.l1_kib));
  }

  const Config& c;
  const OwnKeys& keys_;
  std::string place_;
  const RuleBreach& breach_;
  OwnSections sections_{c.rays, c.packets, c.collections, c.memory, c.testers};
};

}  // namespace

void check_own(const Config& config, const RuleBreach& breach) {
  for_each_own(config.topology, [&](const OwnOf& own) {
    if (own.override == nullptr && config.workload.kind == WorkloadConfig::Kind::kTraffic)
      breach(own_place(own), "synthetic traffic meets nothing of this; expected a node without numbers of its own");
    else if (config.engine.kind == EngineKind::kCycle)
      OwnRules(config, own, breach).check();
  });
}

}  // namespace carousel::config
