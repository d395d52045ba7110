#include "ringbus/cycle/rings/grant_ring.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

GrantRing::GrantRing(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links)
    : RingFabric(shape, std::move(ends), std::move(links)),
      rules_(shape.drawn.drawn->stops),
      stops_(shape.stops),
      lanes_(shape.lanes()) {
  for (Lane& lane : lanes_) lane.free.resize(shape.stops);
}

Cycle GrantRing::next() const {
  Cycle first = kNever;
  for (std::uint32_t i = 0; i < shape_.stops; ++i) first = std::min(first, stops_[i].asks ? 0 : ends_[i]->due());
  return first == kNever ? first : std::max(first, now_ + 1);
}

void GrantRing::step(Cycle now) {
  now_ = now;
  ask(now);
  for (Lane& lane : lanes_)
    lane.ends.erase(std::remove_if(lane.ends.begin(), lane.ends.end(), [&](Cycle end) { return end <= now; }),
                    lane.ends.end());
  if (const std::uint32_t late = overdue(now); late < shape_.stops) {
    if (next_command_ <= now && grant(late, now)) ++use_.reservations;
    return;
  }
  const std::uint32_t first = turn_;
  bool granted = false;
  for (std::uint32_t i = 0; i < shape_.stops && next_command_ <= now; ++i) {
    const std::uint32_t stop = (first + i) % shape_.stops;
    if (!grant(stop, now) || std::exchange(granted, true)) continue;
    turn_ = (stop + 1) % shape_.stops;
  }
}

void GrantRing::ask(Cycle now) {
  for (std::uint32_t i = 0; i < shape_.stops; ++i) {
    Stop& stop = stops_[i];
    if (stop.asks || ends_[i]->due() > now) continue;
    stop.packet = ends_[i]->take(now);
    stop.asks = true;
    stop.granted_after = now + static_cast<Cycle>(rules_.grant_cycles);
  }
}

std::uint32_t GrantRing::overdue(Cycle now) const {
  std::uint32_t late = shape_.stops;
  if (rules_.fair_after_cycles == 0) return late;
  for (std::uint32_t i = 0; i < shape_.stops; ++i) {
    const Stop& stop = stops_[i];
    if (!stop.asks || wanted(stop) + static_cast<Cycle>(rules_.fair_after_cycles) > now) continue;
    if (late == shape_.stops || wanted(stop) < wanted(stops_[late])) late = i;
  }
  return late;
}

bool GrantRing::is_free(const Lane& lane, const RingPacket& packet, std::uint32_t hops, Cycle now) const {
  if (lane.next_start > now) return false;
  if (rules_.transfers && lane.ends.size() >= static_cast<std::size_t>(*rules_.transfers)) return false;
  for (std::uint32_t i = 0; i < hops; ++i)
    if (lane.free[shape_.segment(packet.from, i, packet.direction)] > now + i * shape_.hop) return false;
  return true;
}

/// Grants the request of a stop if all is free that it needs, and returns whether it was.
bool GrantRing::grant(std::uint32_t at, Cycle now) {
  Stop& stop = stops_[at];
  if (!stop.asks || wanted(stop) > now) return false;
  const RingPacket& packet = stop.packet;
  const std::uint32_t hops = shape_.hops(packet.from, packet.to, packet.direction);
  const Cycle head = now + hops * shape_.hop, beats = shape_.beats(packet.bytes);
  if (stops_[packet.to].in_free > head) return false;
  for (std::uint32_t ring = 0; ring < shape_.rings; ++ring) {
    const std::uint32_t number = shape_.lane(packet.direction, ring);
    Lane& lane = lanes_[number];
    if (!is_free(lane, packet, hops, now)) continue;
    use_.longest_wait = std::max(use_.longest_wait, now - wanted(stop));
    use_.longest_ride = std::max(use_.longest_ride, hops * shape_.hop);
    for (std::uint32_t i = 0; i < hops; ++i) {
      const std::uint32_t segment = shape_.segment(packet.from, i, packet.direction);
      lane.free[segment] = now + i * shape_.hop + beats;
      links_.use(shape_.link(segment, number), now + i * shape_.hop, beats, true);
    }
    lane.next_start = now + static_cast<Cycle>(rules_.start_cycles);
    lane.ends.push_back(now + beats);
    next_command_ = now + static_cast<Cycle>(rules_.command_cycles);
    stop.out_free = now + beats;
    stops_[packet.to].in_free = head + beats;
    stop.asks = false;
    ++use_.starts;
    ends_[packet.to]->arrive(packet, head + beats - 1);
    return true;
  }
  return false;
}

}  // namespace carousel::ringbus::cycle
