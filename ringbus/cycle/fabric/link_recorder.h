#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/fabric/token.h"
#include "ringbus/results/packet_history.h"
#include "ringbus/results/slice_log.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus::cycle {

/// Notes the packets that leave by a link, where that is asked for.
struct LinkRecorder {
  SliceLog* slices = nullptr;
  const TripTable* trips = nullptr;
  std::uint32_t track = 0;
  ClockRatio clock{};  ///< from the cycles of the resources, in which times are noted, to those of the sender
  std::vector<PacketHistory>* histories = nullptr;  ///< of all packets
  ClockRatio link{};                                ///< from the cycles of the resources to those of the link

  bool wanted() const { return slices != nullptr || histories != nullptr; }
  /// `begin` and `end` by the clock of the sender, `arrival` by that of the link: an edge of the sender's may be later
  /// than what the packet does next.
  void note(const Token& token, Cycle begin, Cycle end, Cycle arrival) const {
    if (!clock.equal()) {
      begin = clock.before(begin);
      end = clock.to_core(end);
    }
    arrival = link.to_core(arrival);
    // Answers are under way together.
    if (histories != nullptr && !token.passes && !token.answers) (*histories)[token.packet.value].sent(begin, arrival);
    if (slices == nullptr) return;
    // The owner does not wait for a resource that only hears a packet, and may have issued it anew.
    const std::uint64_t trip = token.passes ? 0 : trips->of(token.packet.value);
    slices->add({begin, end, trip, arrival, track, token.packet.value, token.rays, SliceKind::kLink});
  }
};

}  // namespace carousel::ringbus::cycle
