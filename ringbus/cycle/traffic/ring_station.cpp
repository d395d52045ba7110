#include "ringbus/cycle/traffic/ring_station.h"

#include <utility>

namespace carousel::ringbus::cycle {

RingStation::RingStation(std::uint32_t place, const RingShape& shape, const std::vector<std::uint32_t>& places,
                         const Settings& settings, std::optional<TrafficSource> source, std::uint64_t packets,
                         TrafficWindow window)
    : place_(place),
      shape_(shape),
      places_(places),
      settings_(settings),
      source_(std::move(source)),
      left_(packets),
      window_begin_(window.begin),
      sink_(settings.node, window) {
  create();
}

std::uint32_t RingStation::flit_hops(std::uint32_t to, std::uint32_t direction, std::uint32_t bytes) const {
  return shape_.hops(place_, to, direction) * static_cast<std::uint32_t>(shape_.flits(bytes));
}

/// Turns to the source's next packet that goes to another stop.
void RingStation::create() {
  own_.reset();
  while (left_ > 0) {
    --left_;
    source_->advance();
    const Cycle created = source_->created();
    const std::uint32_t to = places_[source_->destination().value];
    if (created >= window_begin_) offer(created, to);
    const Cycle sent = created + settings_.node.inject_cycles;
    if (to == place_) {
      TrafficToken inside;
      inside.created = created;
      sink_.count(inside,
                  sent + (settings_.reply_bytes > 0 ? settings_.serve_cycles : 0) + settings_.node.eject_cycles);
      continue;
    }
    const std::uint32_t random = source_->random(), bytes = settings_.node.packet_bytes;
    const std::uint32_t direction = shape_.direction(place_, to, random);
    own_ = RingPacket{created,   place_, to,
                      direction, random, flit_hops(to, direction, bytes),
                      bytes,     false,  settings_.node.clock.enter(sent)};
    return;
  }
}

/// Counts a packet that is measured, and what its way would take if nothing were in it.
void RingStation::offer(Cycle created, std::uint32_t to) {
  const ClockRatio& clock = settings_.node.clock;
  const Cycle sent = created + settings_.node.inject_cycles;
  const bool answered = settings_.reply_bytes > 0;
  const auto way = [&](std::uint32_t a, std::uint32_t b) { return shape_.hops(a, b, shape_.direction(a, b, 0)); };
  const auto over_the_ring = [&](Cycle at, std::uint32_t hops, std::uint32_t bytes) {
    return to == place_ ? at : clock.leave(clock.enter(at) + shape_.alone(hops, bytes));
  };
  Cycle back = over_the_ring(sent, way(place_, to), settings_.node.packet_bytes);
  if (answered) back = over_the_ring(back + settings_.serve_cycles, way(to, place_), settings_.reply_bytes);
  ++offered_.packets;
  offered_.routers += way(place_, to) + (answered ? way(to, place_) : 0) + 1;
  offered_.travel += back - sent;
}

RingPacket RingStation::take(Cycle now) {
  if (!answers_.empty() && answers_.front().ready <= now) {
    const RingPacket answer = answers_.front();
    answers_.pop_front();
    return answer;
  }
  const RingPacket packet = *own_;
  create();
  return packet;
}

void RingStation::arrive(const RingPacket& packet, Cycle tail) {
  const ClockRatio& clock = settings_.node.clock;
  const Cycle here = clock.leave(tail);
  if (packet.answer || settings_.reply_bytes == 0) {
    TrafficToken token;
    token.created = packet.created;
    token.hops = packet.flit_hops;
    sink_.count(token, here + settings_.node.eject_cycles);
    return;
  }
  const std::uint32_t direction = shape_.direction(place_, packet.from, packet.random);
  answers_.push_back({packet.created, place_, packet.from, direction, packet.random,
                      packet.flit_hops + flit_hops(packet.from, direction, settings_.reply_bytes),
                      settings_.reply_bytes, true, clock.enter(here + settings_.serve_cycles)});
}

}  // namespace carousel::ringbus::cycle
