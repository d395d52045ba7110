#pragma once

#include "core/statistics/link_fault_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct LinkCycles {
  std::uint64_t busy = 0, stalled = 0, idle = 0;

  static constexpr auto counters() {
    using C = LinkCycles;
    return std::array{
        Counter{"busy", &C::busy, "cycles", "the link moved a packet"},
        Counter{"stalled", &C::stalled, "cycles", "a packet waited for a place at the other end"},
        Counter{"idle", &C::idle, "cycles", "there was nothing to move"},
    };
  }
};

struct Link {
  std::uint64_t from = 0, to = 0, depth = 0, packets = 0;
  double occupancy_mean = 0;
  std::uint64_t occupancy_max = 0, stalled = 0;
  std::optional<double> utilisation{};
  std::optional<LinkCycles> cycles{};
  std::optional<std::uint64_t> bytes{};
  std::optional<std::string> queue{};
  std::optional<double> sent_at_once{}, received_at_once{};
  std::optional<std::uint64_t> full_stalls{}, empty_stalls{};
  std::optional<LinkFaultCounts> faults{};
  std::optional<std::string> clock{}, carries{};
};

template <class V>
void describe(V& v, const Link& r) {
  v.field("from", r.from, "", "resource that sends");
  v.field("to", r.to, "", "resource that receives");
  v.field("depth", r.depth, "packets", "capacity of the queue; 0 for a link without packets");
  v.field("packets", r.packets, "packets",
          "packets carried, and other messages that links of a graph carry (topology.links.carries)");
  v.field("occupancy_mean", r.occupancy_mean, "packets",
          "mean of the packets waiting: at every eighth send (native), over time (cycle)");
  v.field("occupancy_max", r.occupancy_max, "packets",
          "most packets waiting: at every eighth send and at refusals (native), at any time (cycle)");
  v.field("stalled", r.stalled, "attempts|cycles",
          "sends refused by the full queue (native), cycles in which a packet waited for a credit (cycle)");
  v.field("utilisation", r.utilisation, "fraction",
          "fraction of the run's cycles in which the link moved a packet (cycle)");
  v.field("bytes", r.bytes, "bytes", "bytes of all that was carried (cycle)");
  v.section("cycles", r.cycles, "cycles of the link; they add up to engine.cycles (cycle)");
  v.field("queue", r.queue, "", "kind of queue (native)");
  v.field("sent_at_once", r.sent_at_once, "packets", "mean of the packets of a send, where it took any (native)");
  v.field("received_at_once", r.received_at_once, "packets",
          "mean of the packets of a reception, where it brought any (native)");
  v.field("full_stalls", r.full_stalls, "sends", "sends of which the queue did not take all packets (native)");
  v.field("empty_stalls", r.empty_stalls, "receptions", "receptions that found no packet (native)");
  v.field("clock", r.clock, "", "name of its clock, where there are several");
  v.field("carries", r.carries, "",
          "what travels over it, as topology.links.carries has it, where links carry more than packets (cycle)");
  v.section("faults", r.faults, "faults of frames and acknowledgements, with faults.links");
}

/// A node of a network that is drawn (topology.shape: graph). Its place in the list is its number.
struct DrawnNode {
  std::string name;
  std::optional<double> x_mm{}, y_mm{};
};

template <class V>
void describe(V& v, const DrawnNode& r) {
  v.field("name", r.name, "", "its name, as topology.links has it");
  v.field("x_mm", r.x_mm, "mm", "its place on the die, if it has one");
  v.field("y_mm", r.y_mm, "mm", "likewise");
}

}  // namespace carousel::report
