#include "ringbus/cycle/shading/travelling_groups.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

TravellingGroups::TravellingGroups(Machine& machine, const ShadingSettings& settings,
                                   const std::vector<SidePorts>& clients, LoadPorts& ports)
    : machine_(machine),
      clients_(clients),
      ports_(ports),
      latency_(control_latency(settings.link)),
      capacity_{settings.slots} {
  if (settings.addressed) {
    capacity_.clear();
    for (std::size_t r = 0; r < clients.size(); ++r) capacity_.push_back(machine.stores[r]->slots());
  }
  free_slots_ = capacity_;
}

void TravellingGroups::add(std::uint32_t issuer, const RayGroup& group) {
  std::vector<std::uint64_t> left(free_slots_.size());
  for (std::size_t i = 0; i < group.rays.size(); ++i) {
    const std::size_t at = group.addresses.empty() ? 0 : group.addresses[i].value;
    if (i == 0 || left[at] == 0) {
      waiting_.push_back({issuer, {}});
      left = capacity_;
    }
    --left[at];
    RayGroup& part = waiting_.back().group;
    part.rays.push_back(group.rays[i]);
    if (!group.addresses.empty()) part.addresses.push_back(group.addresses[i]);
  }
}

/// Takes as many free slots off the count as the group has rays: of the resources that it addresses, or of all.
/// Returns false, and takes none, if they are not free.
bool TravellingGroups::reserve_slots(const RayGroup& group) {
  std::size_t done = 0;
  const auto at = [&](std::size_t i) -> std::uint64_t& {
    return free_slots_[group.addresses.empty() ? 0 : group.addresses[i].value];
  };
  while (done < group.rays.size() && at(done) > 0) --at(done++);
  if (done == group.rays.size()) return true;
  while (done > 0) ++at(--done);
  return false;
}

void TravellingGroups::send(Cycle now) {
  for (; !waiting_.empty(); waiting_.pop_front()) {
    Traveller& next = waiting_.front();
    if (!reserve_slots(next.group)) {
      if (!next.counted) machine_.control.count_slot_wait();
      next.counted = true;
      return;
    }
    const std::uint64_t records = next.group.rays.size();
    const Cycle loaded = ports_.load(next.issuer, records, now);
    clients_[next.issuer].new_rays->send(
        loaded - 1 + latency_,
        {{}, NewRays::Order::kTake, records, std::move(next.group.rays), std::move(next.group.addresses)});
  }
}

}  // namespace carousel::ringbus::cycle
