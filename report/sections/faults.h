#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// A resource that stopped for good.
struct Stop {
  std::uint64_t resource = 0, packets_discarded = 0;
  std::optional<std::uint64_t> stopped_cycle{}, noticed_cycle{}, restarted_cycle{};
};

template <class V>
void describe(V& v, const Stop& r) {
  v.field("resource", r.resource, "", "number of the resource");
  v.field("packets_discarded", r.packets_discarded, "packets",
          "packets of all resources that had been issued and not retired");
  v.field("stopped_cycle", r.stopped_cycle, "cycles", "cycle of the resource's last step");
  v.field("noticed_cycle", r.noticed_cycle, "cycles", "cycle in which ray control excluded the resource");
  v.field("restarted_cycle", r.restarted_cycle, "cycles",
          "cycle in which all packets had been drained and rays were restarted; absent when no ray was unfinished");
}

struct Faults {
  std::optional<Stop> stop{};
  std::optional<std::uint64_t> cycles_without{};
  std::optional<std::int64_t> cycles_lost{};
  std::optional<bool> same_hits{};
};

template <class V>
void describe(V& v, const Faults& r) {
  v.section("stop", r.stop, "a resource that stopped for good");
  v.field("cycles_without", r.cycles_without, "cycles", "cycles of the same run without faults (faults.compare)");
  v.field("cycles_lost", r.cycles_lost, "cycles", "cost of the faults: engine.cycles less cycles_without");
  v.field("same_hits", r.same_hits, "", "true if hits and picture are those of the run without faults");
}

}  // namespace carousel::report
