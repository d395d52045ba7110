#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ringbus/cycle/traffic/delivery_credits.h"
#include "ringbus/cycle/traffic/source_queues.h"
#include "ringbus/cycle/traffic/traffic_agent.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/protocol/flow_rules.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A resource in a network without rays: a source of packets, a sink, and a router with one egress place for each way
/// out. A packet that arrives for another resource goes on in the same cycle if its link is free (cut-through: its tail
/// may still be arriving), so a hop takes topology.link.latency_cycles. A packet of L flits whose destination is h hops
/// away takes, from its creation until its last flit is delivered and if no other packet is in its way,
///     inject_cycles + h * latency_cycles + L - 1 + eject_cycles.
/// Packets on their way go before packets of the source.
///
/// Packets that go only part of the way round a ring cannot stop it (docs/how-it-works/design.md, Deadlock and the
/// end):
/// - `bubble`: a packet is injected only if it leaves a free place in the next queue, so injecting never fills a round
///   of queues, and moving on does not change how many are full. Some packet always has a free place ahead
///   (V. Puente et al., The adaptive bubble router, J. Parallel and Distributed Computing 61 (2001)).
/// - `credits`: a source has at most `depth` packets on each ring until an acknowledgement says that one was delivered,
///   so R sources have R * depth packets against R * depth places in queues and R egress places: a place is always
///   free. Acknowledgements travel on wires of their own that are never full, in the direction that the topology names.
/// - `none`: nothing prevents it, and packets of the source go first, so that it shows.
/// - The sink takes every packet after a bounded time, so point to point no packet waits for another one to move.
class TrafficNode final : public TrafficAgent {
 public:
  struct Ports {
    std::vector<In> in;
    std::vector<Out> out;                      ///< as many; what comes in by one goes on by its fellow
    DeliveryCredits::Wires acks_in, acks_out;  ///< empty where no source waits for acknowledgements
  };

  /// Keeps a reference to the topology. `packets`: how many it takes from the source.
  TrafficNode(ResourceId id, const Topology& topology, const FlowRules& flow, const TrafficNodeSettings& settings,
              TrafficSource source, std::uint64_t packets, TrafficWindow window, Ports ports);

  Cycle next() const override;
  bool polled() const override { return awaits_credit_; }  // no wakeup tells of credits
  Cycle unannounced() const override { return next_here(); }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  Moved moved(std::size_t port) const override {
    const Out& out = ways_[port].out;
    return {out.packets(), out.busy(), out.stalled()};
  }
  TrafficOffered offered() const override {
    const std::uint64_t packets = queues_.offered(), routers = queues_.routers();
    return {packets, routers, (routers - packets) * link_latency_ + packets * (flits_ - 1u)};
  }
  Cycle busy_in_window(std::size_t port) const override { return busy_before(port, 1) - busy_before(port, 0); }

 private:
  struct Way {
    In in;
    Out out;
    Cycle arrival = 0;            // the next one; noted when a window begins
    std::array<Cycle, 2> busy{};  // cycles in which `out` moved a flit before the marks that are passed
  };

  void advance(Cycle end);
  void pass_marks(Cycle end);
  Cycle busy_before(std::size_t port, std::size_t i) const {
    return i < marks_passed_ ? ways_[port].busy[i] : ways_[port].out.busy(mark(i));
  }
  Cycle next_here() const;
  Cycle next_injection() const;
  Cycle next_injection(const SourceQueues::Queue& queue) const;
  bool awaits_credit() const;
  void send(Cycle now);
  void pass_all(Cycle now);
  Cycle run_unhindered(Cycle end);
  Way& first_way();
  bool pass(Way& way, Cycle now);
  void inject_all(Cycle now);
  void inject(SourceQueues::Queue& queue, Cycle now);

  ResourceId id_;
  std::vector<Way> ways_;
  std::size_t marks_passed_ = 0;  // ends of the window that have passed
  std::uint16_t flits_;
  Cycle link_latency_;
  std::uint32_t places_wanted_;  // in the next queue, to inject
  bool injects_first_;           // before packets on their way

  Cycle now_ = 0;
  Cycle next_ = 0;                // next(), at the end of the last run()
  bool awaits_credit_ = false;    // likewise: a credit may let it do something before next_
  std::size_t egress_count_ = 0;  // packets in egress places
  std::size_t first_in_ = 0;      // the way that has the sink before the others

  SourceQueues queues_;
  DeliveryCredits credits_;
};

}  // namespace carousel::ringbus::cycle
