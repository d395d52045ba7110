#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/parcels/link_time.h"
#include "ringbus/cycle/parcels/parcel.h"
#include "ringbus/time/agent.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A link that packets and parcels share. It stands a cycle behind the link's near end and gives out the link's time in
/// the order in which they come, in turns where both come at once. Packets alone travel as if it were not there. They
/// have credits as on any link, which parcels neither need nor hold; so a packet never waits for a parcel but for the
/// time that this occupies the link, and the other way round. It goes by the link's clock.
class SharedLink final : public Agent {
 public:
  /// The two parts of the link's channels, before and behind this agent.
  struct Ends {
    Wire *near = nullptr, *far = nullptr;
    Channel<Parcel>*parcels_in = nullptr, *parcels_out = nullptr;
  };
  /// The latency of the part behind the agent, of a link with this latency. A link has two cycles at least, though the
  /// search for the bottleneck may ask for one.
  static Cycle far_latency(std::int64_t latency) { return static_cast<Cycle>(std::max<std::int64_t>(2, latency)) - 1; }

  /// `wire`: the topology's number of the link. `from_core`: to its clock. Keeps a reference to the topology.
  SharedLink(const Topology& topology, std::uint32_t wire, const Ends& ends, const ClockRatio& from_core = {});

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override { return ""; }

  LinkTime& time() { return time_; }

 private:
  void step(Cycle now);
  void send_packet(Cycle now);
  void send_parcel(Cycle now);

  const Topology& topology_;
  ResourceId from_;
  Ends ends_;
  Cycle latency_;          // of the far part
  std::size_t ahead_ = 0;  // packets of the near part that have gone on; they leave it when their credits come back
  bool parcels_first_ = false;
  LinkTime time_;
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
