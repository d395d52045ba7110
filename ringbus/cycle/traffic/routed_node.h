#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ringbus/cycle/traffic/traffic_agent.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A node of a graph without rays: a router with a queue at the end of each link that leads to it and, at a resource, a
/// source and a sink. There are no places before the links that leave: a packet waits in its queue, and holds up those
/// behind it, until its link is free and has a place at the other end. Queues, the source among them, have their turns
/// at each link and at the sink. One flit a cycle leaves a queue, the source, and gets out to the sink.
///
/// A packet of L flits, from its creation until its last flit is delivered and if no other packet is in its way, takes
///     inject_cycles + sum over its links of (node_cycles + latency_cycles) + L - 1 + eject_cycles
/// where node_cycles are those of the node before the link. A packet that changes to a link of another width, or at a
/// router with `forward: whole`, is stored whole and takes its length once more.
class RoutedNode final : public TrafficAgent {
 public:
  struct Ports {
    std::vector<In> in;
    std::vector<Out> out;
  };

  /// Keeps a reference to the topology. `source`: of a resource, from which `packets` are taken.
  RoutedNode(ResourceId id, const Topology& topology, const TrafficNodeSettings& settings,
             std::optional<TrafficSource> source, std::uint64_t packets, TrafficWindow window, Ports ports);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  const Out& out(std::size_t port) const override { return out_[port]; }
  TrafficOffered offered() const override { return offered_; }
  Cycle busy_in_window(std::size_t port) const override { return busy_before(port, 1) - busy_before(port, 0); }

 private:
  /// The source, and the packet that it has created or will create next.
  struct Source {
    std::optional<TrafficSource> packets;
    std::uint64_t left = 0;  // after that packet
    TrafficToken token;
    Cycle ready = kNever, free = 0;  // not injected before
  };
  struct Exit {
    std::size_t turn = 0;         // the queue that goes first
    std::array<Cycle, 2> busy{};  // cycles in which a flit left before the marks that are passed
  };

  void step(Cycle now);
  void pass_marks(Cycle now);
  Cycle busy_before(std::size_t port, std::size_t i) const {
    return i < marks_passed_ ? exits_[port].busy[i] : out_[port].busy(mark(i));
  }
  void create();
  Cycle alone(ResourceId to) const;
  /// When the first packet of a queue is there; kNever without one.
  Cycle ready(std::size_t queue) const { return queue < in_.size() ? in_[queue].next() : source_.ready; }
  const TrafficToken& first(std::size_t queue) const { return queue < in_.size() ? in_[queue].front() : source_.token; }
  /// The port of a packet's next link; behind those, the sink.
  std::size_t exit_of(const TrafficToken& token) const {
    return token.stop == id_.value ? out_.size() : topology_.exit(id_, ResourceId(token.stop)).port;
  }
  bool grant(std::size_t exit, Cycle now);
  void move(std::size_t queue, std::size_t exit, Cycle now);

  ResourceId id_;
  const Topology& topology_;
  TrafficNodeSettings settings_;
  std::vector<In> in_;
  std::vector<Out> out_;
  std::vector<std::uint16_t> cycles_;  // of a packet on each link
  std::vector<Cycle> queue_free_;      // by link, and the source: a flit leaves until then
  std::vector<Exit> exits_;            // by link, and the sink
  Source source_;
  TrafficOffered offered_;
  Cycle now_ = 0;
  std::size_t marks_passed_ = 0;  // ends of the window
};

}  // namespace carousel::ringbus::cycle
