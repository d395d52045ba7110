#include "ringbus/cycle/parcels/shared_link.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

SharedLink::SharedLink(const Topology& topology, std::uint32_t wire, const Ends& ends, const ClockRatio& from_core)
    : topology_(topology),
      from_(topology.wires()[wire].from),
      ends_(ends),
      latency_(far_latency(topology.wires()[wire].latency_cycles)),
      time_(static_cast<std::uint64_t>(topology.wires()[wire].bytes_per_cycle), from_core) {}

Cycle SharedLink::next() const {
  return std::min({ends_.near->packets.next_after(now_), ends_.parcels_in->next(), ends_.far->packets.next_return()});
}

void SharedLink::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void SharedLink::step(Cycle now) {
  now_ = now;
  for (std::uint32_t back = ends_.far->packets.take_returns(now); back > 0; --back, --ahead_)
    ends_.near->packets.take(now + 1);
  std::size_t packets = ends_.near->packets.arrived(now) - ahead_;
  for (bool parcels; (parcels = ends_.parcels_in->next() <= now) || packets > 0;) {
    parcels_first_ = packets == 0 || (parcels && !parcels_first_);
    if (parcels_first_) {
      send_parcel(now);
    } else {
      send_packet(now);
      --packets;
    }
  }
}

/// The near end has sent the packet a cycle ago, or that its tail comes now.
void SharedLink::send_packet(Cycle now) {
  const Token token = ends_.near->packets.peek(ahead_);
  const Cycle behind = topology_.exit(from_, ResourceId(token.stop), token.lane).through ? 0 : token.link_cycles - 1;
  const Cycle begin = time_.packet(token.link_cycles, now - std::min<Cycle>(now, behind));
  ends_.far->packets.send(begin + behind + latency_, token);
  ++ahead_;
}

void SharedLink::send_parcel(Cycle now) {
  Parcel parcel = ends_.parcels_in->take();
  const LinkTime::Passage passage = time_.parcel(parcel.bytes(), now);
  const Cycle leaves = parcel.through ? passage.head : passage.tail;
  ends_.parcels_out->send(leaves + latency_, std::move(parcel));
}

}  // namespace carousel::ringbus::cycle
