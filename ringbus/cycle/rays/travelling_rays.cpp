#include "ringbus/cycle/rays/travelling_rays.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

TravellingRays::TravellingRays(Machine& machine, ResourceId here, const LinkConfig& link, RayTimes* times)
    : machine_(machine),
      here_(here),
      on_(machine.control.rays_travel()),
      times_(times != nullptr ? &times->of(here) : nullptr),
      rounds_(machine, here),
      record_cycles_(ceil_div(sizeof(RayRecord), static_cast<std::uint64_t>(link.bytes_per_cycle))),
      placed_at_(on_ ? machine.stores[here.value]->slots() : 0) {}

void TravellingRays::arrive(NewRays&& rays) {
  waiting_.push_back({{}, std::move(rays.rays), std::move(rays.addresses)});
}

void TravellingRays::load(Packet& packet) {
  rounds_.load(waiting_.front(), packet);
  waiting_.pop_front();
}

Cycle TravellingRays::take_slots(Packet& packet, Cycle now) {
  const std::size_t before = packet.members.size();
  std::vector<RayId> own = rounds_.take_slots(packet);
  for (const RayId id : own) note_taken(id, now);
  for (std::size_t i = before; i < packet.members.size(); ++i) note_taken(packet.members[i].ray, now);
  taken_ = own.size() + packet.members.size() - before;
  if (taken_ == 0) return now;
  load_free_ = std::max(load_free_, now) + taken_ * record_cycles_;
  held_.change(now, static_cast<std::int64_t>(taken_));
  if (!own.empty()) due_.push_back({load_free_, std::move(own)});
  return load_free_;
}

void TravellingRays::note_taken(RayId id, Cycle now) {
  RayStore& store = *machine_.stores[here_.value];
  const std::uint32_t slot = store.slot(id);
  placed_at_[slot] = now;
  if (times_ != nullptr) times_->found(slot, store.record(slot).tag, now);
}

void TravellingRays::retire_at_owner(Packet& packet, Cycle now) {
  const Cycle loaded = take_slots(packet, now);
  RayGroup group = rounds_.unload(packet);
  packet.members.clear();
  if (!group.ids.empty())
    due_.push_back({due_.empty() ? loaded : std::max(loaded, due_.back().at), std::move(group.ids)});
  if (!group.rays.empty()) waiting_.push_back({{}, std::move(group.rays), std::move(group.addresses)});
}

bool TravellingRays::admit(Cycle now, Admission& admission) {
  bool any = false;
  for (; !due_.empty() && due_.front().at <= now; due_.pop_front()) {
    admission.add(std::move(due_.front().ids));
    any = true;
  }
  return any;
}

std::vector<Cycle> TravellingRays::free(std::span<const std::uint32_t> slots, Cycle now) {
  std::vector<Cycle> placed;
  for (const std::uint32_t slot : slots) placed.push_back(placed_at_[slot]);
  held_.change(now, -static_cast<std::int64_t>(slots.size()));
  machine_.control.free(here_, slots);
  return placed;
}

}  // namespace carousel::ringbus::cycle
