#include "ringbus/cycle/rings/slot_ring.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

SlotRing::SlotRing(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links)
    : RingFabric(shape, std::move(ends), std::move(links)),
      length_(shape.stops * shape.hop),
      port_cycles_(shape.port_cycles()),
      fair_after_(static_cast<Cycle>(shape.drawn.drawn->stops.fair_after_cycles)),
      slots_(shape.lanes() * length_),
      stops_(shape.stops) {}

Cycle SlotRing::next() const {
  // While flits are under way one gets off within a round, since the port that another finds busy has just taken one,
  // unless none of them finds a place.
  const Cycle round = length_ + 2 * port_cycles_;
  const bool stuck = rides();
  if (stuck && now_ - moved_ <= round) return now_ + 1;
  Cycle first = kNever;
  for (const RingEnd* end : ends_)
    if (const Cycle due = end->due(); !stuck || due > now_) first = std::min(first, due);
  return first == kNever ? first : std::max(first, now_ + 1);
}

void SlotRing::step(Cycle now) {
  while (rides() && now_ + 1 < now) turn(now_ + 1);
  turn(now);
}

void SlotRing::turn(Cycle now) {
  now_ = now;
  for (std::uint32_t stop = 0; stop < shape_.stops; ++stop) {
    get_off(stop, now);
    get_on(stop, now);
    for (std::uint32_t lane = 0; lane < shape_.lanes(); ++lane)
      if (const Slot& leaves = slot(lane, stop, now); leaves.packet != kNone)
        links_.use(shape_.link(shape_.segment(stop, 0, lane / shape_.rings), lane), now, 1, leaves.first);
  }
}

/// The slot that is at a stop. Slot n stands n cycles ahead of the first stop at time 0.
SlotRing::Slot& SlotRing::slot(std::uint32_t lane, std::uint32_t stop, Cycle now) {
  const Cycle place = stop * shape_.hop, turned = now % length_;
  const bool ahead = lane < shape_.rings;
  return slots_[lane * length_ + (ahead ? place + length_ - turned : place + turned) % length_];
}

/// Tells whether a packet has a place at its stop, or may take one. If not, it may be the next that does.
bool SlotRing::finds_place(std::uint32_t at, std::uint32_t packet) {
  if (flying_[packet].has_place) return true;
  std::uint32_t& line = stops_[at].first_in_line;
  const bool first = line == kNone || line == packet || flying_[packet].began < flying_[line].began;
  if (first && ends_[at]->has_place()) return true;
  if (first) line = packet;
  return false;
}

void SlotRing::get_off(std::uint32_t stop, Cycle now) {
  const Slot* second = nullptr;  // of those that come, after the oldest
  Slot* oldest = nullptr;
  for (std::uint32_t lane = 0; lane < shape_.lanes(); ++lane) {
    Slot& here = slot(lane, stop, now);
    if (here.packet == kNone || here.to != stop) continue;
    if (!finds_place(stop, here.packet)) {
      ++use_.extra_rounds;
      continue;
    }
    use_.extra_rounds += oldest != nullptr;
    if (oldest == nullptr || here.entered < oldest->entered)
      second = std::exchange(oldest, &here);
    else if (second == nullptr || here.entered < second->entered)
      second = &here;
  }
  if (oldest == nullptr) return;
  Port& port = stops_[stop].port;
  if (port.claimed_at <= now) port.claimed_at = kNever;
  if (port.free > now || port.is_kept(now, port_cycles_, oldest->entered)) {
    ++use_.extra_rounds;
    port.claim(now + length_, oldest->entered);
    return;
  }
  if (second != nullptr) port.claim(now + length_, second->entered);
  port.free = now + port_cycles_;
  use_.longest_ride = std::max(use_.longest_ride, now - oldest->entered);
  moved_ = now;
  const std::uint32_t id = std::exchange(oldest->packet, kNone);
  if (!std::exchange(flying_[id].has_place, true)) {
    ends_[stop]->keep_place();
    if (stops_[stop].first_in_line == id) stops_[stop].first_in_line = kNone;
  }
  if (--flying_[id].left > 0) return;
  ends_[stop]->arrive(flying_[id].packet, now + port_cycles_ - 1);
  unused_.push_back(id);
}

void SlotRing::get_on(std::uint32_t stop, Cycle now) {
  Stop& here = stops_[stop];
  if (here.packet == kNone && ends_[stop]->due() <= now) begin_packet(stop, now);
  if (here.packet == kNone || here.ready > now) return;
  Slot* const free = free_slot(stop, now);
  if (free == nullptr) {
    if (fair_after_ > 0 && here.marked == nullptr && now - here.ready >= fair_after_) mark_slot(stop, now);
    return;
  }
  if (here.marked != nullptr) std::exchange(here.marked, nullptr)->marked = kNone;
  use_.longest_wait = std::max(use_.longest_wait, now - here.ready);
  free->packet = here.packet;
  free->to = flying_[here.packet].packet.to;
  free->entered = now;
  free->first = std::exchange(here.first, false);
  here.ready = now + port_cycles_;
  moved_ = now;
  if (--here.left == 0) here.packet = kNone;
}

void SlotRing::begin_packet(std::uint32_t stop, Cycle now) {
  Stop& here = stops_[stop];
  const RingPacket packet = ends_[stop]->take(now);
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::uint32_t>(flying_.size()));
    flying_.emplace_back();
  }
  here.packet = unused_.back();
  unused_.pop_back();
  here.left = static_cast<std::uint32_t>(shape_.flits(packet.bytes));
  here.first = true;
  here.ready = now + port_cycles_ - 1;
  flying_[here.packet] = {packet, here.left, now};
  moved_ = now;
  ++use_.starts;
}

/// A slot at a stop into which its flit may go.
SlotRing::Slot* SlotRing::free_slot(std::uint32_t stop, Cycle now) {
  const std::uint32_t direction = flying_[stops_[stop].packet].packet.direction;
  for (std::uint32_t ring = 0; ring < shape_.rings; ++ring) {
    Slot& passing = slot(shape_.lane(direction, ring), stop, now);
    if (passing.packet == kNone && (passing.marked == kNone || passing.marked == stop)) return &passing;
  }
  return nullptr;
}

void SlotRing::mark_slot(std::uint32_t stop, Cycle now) {
  const std::uint32_t direction = flying_[stops_[stop].packet].packet.direction;
  for (std::uint32_t ring = 0; ring < shape_.rings; ++ring) {
    Slot& passing = slot(shape_.lane(direction, ring), stop, now);
    if (passing.marked != kNone) continue;
    passing.marked = stop;
    stops_[stop].marked = &passing;
    ++use_.reservations;
    return;
  }
}

}  // namespace carousel::ringbus::cycle
