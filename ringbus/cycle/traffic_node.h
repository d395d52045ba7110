#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/config.h"
#include "ringbus/cycle/agent.h"
#include "ringbus/cycle/latency_histogram.h"
#include "ringbus/cycle/ports.h"
#include "ringbus/cycle/traffic_route.h"
#include "ringbus/cycle/traffic_source.h"
#include "ringbus/cycle/traffic_token.h"

namespace carousel::ringbus::cycle {

/// What is measured: packets created from `begin` on; sources stop before `end`.
struct TrafficWindow {
  Cycle begin = 0, end = 0;
};

/// A resource in a network without rays: a source of packets, a sink, and a router with one place in hand for each
/// way out. A packet that arrives for another resource goes on in the same cycle if its link is free (cut-through:
/// its tail may still be arriving), so a hop takes topology.link.latency_cycles. From its creation to the last of
/// its L flits' delivery, h hops away and with nobody in its way, a packet takes
///     inject_cycles + h * latency_cycles + L - 1 + eject_cycles.
/// One flit a cycle gets in from the source, and one out to the sink. What travels goes before what wants in. The
/// source's queue is endless, and first in, first out.
///
/// Why packets that go part of the way round a ring cannot stop it (DESIGN.md section 4):
/// - `bubble`: a packet is injected only if it leaves a free place in the next queue, so no round of queues is ever
///   filled by injecting, and moving on does not change how many are full. Some packet always has a free place ahead
///   (V. Puente et al., The adaptive bubble router, J. Parallel and Distributed Computing 61 (2001)).
/// - `credits`: a source has at most `depth` packets on each ring until word comes that one was delivered, so R
///   sources have R * depth packets against R * depth places in queues and R in hands: a place is always free. Word
///   of a delivery travels on wires of its own that are never full (round a ring that has only one direction, back
///   the other way of one that has two).
/// - The sink takes every packet after a bounded time, so point to point no packet waits for another to move.
class TrafficNode final : public Agent {
 public:
  using In = InPortOf<TrafficToken>;
  using Out = OutPortOf<TrafficToken>;
  struct Ports {
    std::vector<In> in;     ///< a ring: by direction
    std::vector<Out> out;   ///< a ring: by direction; point to point: by `out_to`
    std::vector<std::uint32_t> out_to;            ///< point to point: by destination
    std::vector<Channel<TrafficAck>*> acks_in, acks_out;   ///< by direction; empty where nobody waits for them
  };

  /// `packets`: that it creates.
  TrafficNode(ResourceId id, const Config& config, std::uint64_t packets, TrafficWindow window, Ports ports);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  const std::vector<Out>& out() const { return ports_.out; }
  const LatencyHistogram& latency() const { return latency_; }   ///< of measured packets delivered here
  std::uint64_t flits() const { return flits_; }         ///< of a packet
  std::uint64_t delivered() const { return delivered_; }
  std::uint64_t accepted() const { return accepted_; }   ///< delivered within the window
  std::uint64_t offered() const { return offered_; }     ///< created within the window
  std::uint64_t routers() const { return routers_; }     ///< that the packets offered had to visit, first and last included
  Cycle last() const { return last_; }                   ///< when something was last delivered

 private:
  void step(Cycle now);
  void take_acks(Cycle now);
  void pass(std::size_t d, Cycle now);
  void inject(Cycle now);
  Cycle next_injection() const;
  bool sink_open(Cycle tail) const { return sink_free_ <= tail; }
  void deliver(const TrafficToken& token, Cycle tail);
  void create();
  std::size_t ack_direction(std::size_t d) const;

  const TopologyConfig& topology_;
  ResourceId id_;
  Ports ports_;
  TrafficSource source_;
  TrafficWindow window_;
  Cycle inject_cycles_, eject_cycles_, ack_latency_;
  std::uint16_t flits_;
  std::uint32_t places_wanted_;   // in the next queue, to inject

  Cycle now_ = 0;
  std::uint64_t to_create_;
  bool waiting_ = false;          // there is a packet to inject, no matter whether it has been created yet
  TrafficRoute route_;            // the packet's
  std::size_t exit_ = 0;
  Cycle ready_ = 0;               // not injected before
  Cycle inject_free_ = 0, sink_free_ = 0;   // sink_free_: the next packet's tail, not before
  std::size_t first_in_ = 0;
  std::vector<std::uint32_t> window_left_;  // packets it may still send, by direction; empty: any number

  LatencyHistogram latency_;
  std::uint64_t delivered_ = 0, accepted_ = 0, offered_ = 0, routers_ = 0;
  Cycle last_ = 0;
};

}  // namespace carousel::ringbus::cycle
