#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_token.h"
#include "ringbus/time/channel.h"
#include "ringbus/time/fifo.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// The credits of a source on each ring (`topology.flow: credits`): it has at most `depth` packets on the way there,
/// and may send a further one for each acknowledgement that says that one was delivered. Acknowledgements of other
/// sources' packets are passed on, those of packets delivered here are sent off.
class DeliveryCredits {
 public:
  using Wires = std::vector<Channel<TrafficAck>*>;  ///< by direction

  /// Keeps a reference to the topology. Without wires there are no credits, and none of the calls that name a direction
  /// is allowed.
  DeliveryCredits(ResourceId id, const Topology& topology, const TrafficNodeSettings& settings, Wires in, Wires out)
      : topology_(topology),
        id_(id),
        latency_(settings.link_latency),
        in_(std::move(in)),
        out_(std::move(out)),
        allowances_(in_.size(), {settings.link_depth, {}}),
        passing_(in_.size()) {}

  bool on() const { return !allowances_.empty(); }
  /// The time at which the next acknowledgement comes.
  Cycle next() const;
  /// Takes the acknowledgements that come before `end`.
  void take(Cycle end);
  /// Passes on what has come before `end` for other sources.
  void forward(Cycle end) {
    for (std::size_t a = 0; a < passing_.size(); ++a) forward(a, end);
  }
  /// Acknowledges a packet that has been delivered here `now` and came by this direction.
  void acknowledge(const TrafficToken& token, std::size_t direction, Cycle now);
  /// Uses up a credit, if there is one, and returns whether there was.
  bool use(std::size_t direction, Cycle now);
  /// The time, as far as is known, from which there is a credit; `now` if there is one.
  Cycle opens(std::size_t direction, Cycle now) const {
    const Allowance& allowance = allowances_[direction];
    if (allowance.left > 0) return now;
    if (allowance.acks.empty()) return kNever;
    return allowance.acks.front() > now ? allowance.acks.front() : now;
  }

 private:
  struct Allowance {
    std::uint32_t left = 0;  // packets that it may send besides those on the way
    Fifo<Cycle> acks;        // times at which there will be one more
  };
  struct PassingAck {
    Cycle at = 0;
    TrafficAck ack;
  };

  void forward(std::size_t a, Cycle end);

  const Topology& topology_;
  ResourceId id_;
  Cycle latency_;
  Wires in_, out_;
  std::vector<Allowance> allowances_;      // by direction of the packets
  std::vector<Fifo<PassingAck>> passing_;  // by direction of the acknowledgements
};

}  // namespace carousel::ringbus::cycle
