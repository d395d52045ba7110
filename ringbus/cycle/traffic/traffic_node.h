#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/numeric/latency_histogram.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/cycle/traffic/traffic_token.h"
#include "ringbus/protocol/flow_rules.h"
#include "ringbus/time/agent.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// The parts of the configuration that a node follows.
struct TrafficNodeSettings {
  Cycle inject_cycles = 0, eject_cycles = 0;
  Cycle link_latency = 1;
  std::uint32_t link_depth = 1;
  std::uint16_t flits = 1;   ///< flits of a packet
  bool shared_queue = true;  ///< the source has one queue for all packets
};

inline TrafficNodeSettings traffic_node_settings(const TrafficConfig& traffic, const LinkConfig& link) {
  return {static_cast<Cycle>(traffic.inject_cycles),
          static_cast<Cycle>(traffic.eject_cycles),
          static_cast<Cycle>(link.latency_cycles),
          static_cast<std::uint32_t>(link.depth),
          static_cast<std::uint16_t>(ceil_div(static_cast<std::uint64_t>(traffic.packet_bytes),
                                              static_cast<std::uint64_t>(link.bytes_per_cycle))),
          traffic.source_queues == TrafficConfig::SourceQueues::kShared};
}

/// A resource in a network without rays: a source of packets, a sink, and a router with one egress place for each way
/// out. A packet that arrives for another resource goes on in the same cycle if its link is free (cut-through: its tail
/// may still be arriving), so a hop takes topology.link.latency_cycles. A packet of L flits whose destination is h hops
/// away takes, from its creation until its last flit is delivered and if no other packet is in its way,
///     inject_cycles + h * latency_cycles + L - 1 + eject_cycles.
/// Packets on their way go before packets of the source. The source has one queue, or one for each way out and one for
/// packets that stay here. A queue has no bound and is first in, first out, and one flit a cycle leaves it. One flit a
/// cycle gets out to the sink.
///
/// Packets that go only part of the way round a ring cannot stop it (docs/design.md, Deadlock and the end):
/// - `bubble`: a packet is injected only if it leaves a free place in the next queue, so injecting never fills a round
///   of queues, and moving on does not change how many are full. Some packet always has a free place ahead
///   (V. Puente et al., The adaptive bubble router, J. Parallel and Distributed Computing 61 (2001)).
/// - `credits`: a source has at most `depth` packets on each ring until an acknowledgement says that one was delivered,
///   so R sources have R * depth packets against R * depth places in queues and R egress places: a place is always
///   free. Acknowledgements travel on wires of their own that are never full, in the direction that the topology names.
/// - `none`: nothing prevents it, and packets of the source go first, so that it shows.
/// - The sink takes every packet after a bounded time, so point to point no packet waits for another one to move.
class TrafficNode final : public Agent {
 public:
  using In = InPortOf<TrafficToken>;
  using Out = OutPortOf<TrafficToken>;
  struct Ports {
    std::vector<In> in;
    std::vector<Out> out;                                 ///< as many; what comes in by one goes on by its fellow
    std::vector<Channel<TrafficAck>*> acks_in, acks_out;  ///< by direction; empty where no source waits for them
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

  /// The ports of `ports.out`, in their order.
  const Out& out(std::size_t port) const { return ways_[port].out; }
  const LatencyHistogram& latency() const { return latency_; }  ///< latency of measured packets delivered here
  std::uint64_t flits() const { return flits_; }                ///< flits of a packet
  std::uint64_t delivered() const { return delivered_; }
  std::uint64_t accepted() const { return accepted_; }            ///< delivered within the window
  std::uint64_t accepted_hops() const { return accepted_hops_; }  ///< links that these crossed
  std::uint64_t offered() const { return offered_; }              ///< created within the window
  /// Routers that the packets offered had to visit, first and last included.
  std::uint64_t routers() const { return routers_; }
  Cycle last() const { return last_; }  ///< when something was last delivered
  /// Cycles of the window in which the link of `ports.out` moved a flit, once the run is over.
  Cycle busy_in_window(std::size_t port) const { return busy_before(port, 1) - busy_before(port, 0); }

 private:
  /// The source as one queue sees it: it reads on to the next packet that is its own. All queues read the same packets,
  /// so none of them has to be stored.
  struct SourceQueue {
    TrafficSource source;
    std::uint64_t to_create;  // after the packet that it looks at
    bool waiting = false;     // it looks at a packet; the packet need not have been created yet
    bool mine = false;        // the packet takes the way of this queue
    Topology::Route route{};
    std::size_t exit = 0;
    Cycle ready = 0, free = 0;  // not injected before
    Cycle due = kNever;         // when it has something to do, if nothing is in its way
  };

  struct Way {
    In in;
    Out out;
    Cycle arrival = 0;            // the next one; noted when a window begins
    std::array<Cycle, 2> busy{};  // cycles in which `out` moved a flit before the marks that are passed
  };

  void advance(Cycle end);
  void pass_marks(Cycle end);
  Cycle mark(std::size_t i) const { return i == 0 ? window_.begin : window_.end; }
  Cycle busy_before(std::size_t port, std::size_t i) const {
    return i < marks_passed_ ? ways_[port].busy[i] : out(port).busy(mark(i));
  }
  Cycle next_here() const;
  Cycle next_injection() const;
  Cycle next_injection(const SourceQueue& queue) const;
  Cycle next_ack() const;
  bool awaits_credit() const;
  void send(Cycle now);
  void pass_all(Cycle now);
  void take_acks(Cycle end);
  void forward_acks(std::size_t a, Cycle end);
  void acknowledge(const TrafficToken& token, std::size_t d, Cycle now);
  bool may_send_more(std::size_t direction, Cycle now);
  Cycle run_unhindered(Cycle end);
  Way& first_way();
  bool pass(Way& way, Cycle now);
  void inject_all(Cycle now);
  void inject(SourceQueue& queue, Cycle now);
  bool sink_open(Cycle tail) const { return sink_free_ <= tail; }
  void deliver(const TrafficToken& token, Cycle tail);
  void create(SourceQueue& queue);
  void look_at_next(SourceQueue& queue);

  const Topology& topology_;
  ResourceId id_;
  std::vector<Way> ways_;
  std::vector<Channel<TrafficAck>*> acks_in_, acks_out_;
  TrafficWindow window_;
  std::size_t marks_passed_ = 0;  // ends of the window that have passed
  Cycle inject_cycles_, eject_cycles_, ack_latency_;
  std::uint16_t flits_;
  std::uint32_t places_wanted_;  // in the next queue, to inject

  Cycle now_ = 0;
  Cycle next_ = 0;                // next(), at the end of the last run()
  Cycle due_ = kNever;            // the first of the queues' due
  bool awaits_credit_ = false;    // likewise: a credit may let it do something before next_
  std::size_t egress_count_ = 0;  // packets in egress places
  std::size_t first_in_ = 0;      // the way that has the sink before the others
  Cycle sink_free_ = 0;           // for the next packet's tail

  bool injects_first_;  // before packets on their way

  std::vector<SourceQueue> queues_;  // one; or by way out, and the last one for packets that stay here
  struct Allowance {
    std::uint32_t left = 0;  // packets that it may send besides those on the way
    Fifo<Cycle> acks;        // times at which there will be one more
  };
  std::vector<Allowance> allowances_;  // by direction; empty: any number
  struct PassingAck {
    Cycle at = 0;
    TrafficAck ack;
  };
  std::vector<Fifo<PassingAck>> passing_acks_;  // by their direction

  LatencyHistogram latency_;
  std::uint64_t delivered_ = 0, accepted_ = 0, accepted_hops_ = 0, offered_ = 0, routers_ = 0;
  Cycle last_ = 0;
};

}  // namespace carousel::ringbus::cycle
