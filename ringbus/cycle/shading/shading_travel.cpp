// New rays that travel round the ring to find slots: ray control sends no more of them than there are free slots, so
// that every one finds a slot and packets need not go round for ever.
#include <algorithm>

#include "ringbus/cycle/shading/shading_agent.h"

namespace carousel::ringbus::cycle {

void ShadingAgent::gather_travellers() {
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    groups_.clear();
    machine_.control.collect(ResourceId(r), groups_);
    for (const RayGroup& group : groups_) add_traveller(r, group);
  }
}

/// Cuts a group before each ray for which its resource, or all of them, would not have enough slots even if they were
/// empty.
void ShadingAgent::add_traveller(std::uint32_t issuer, const RayGroup& group) {
  std::vector<std::uint64_t> left(free_slots_.size());
  for (std::size_t i = 0; i < group.rays.size(); ++i) {
    const std::size_t at = group.addresses.empty() ? 0 : group.addresses[i].value;
    if (i == 0 || left[at] == 0) {
      travellers_.push_back({issuer, {}});
      std::fill(left.begin(), left.end(), slots_ / left.size());
    }
    --left[at];
    RayGroup& part = travellers_.back().group;
    part.rays.push_back(group.rays[i]);
    if (!group.addresses.empty()) part.addresses.push_back(group.addresses[i]);
  }
}

/// Takes as many free slots off the count as the group has rays: of the resources that it addresses, or of all.
/// Returns false, and takes none, if they are not free.
bool ShadingAgent::reserve_slots(const RayGroup& group) {
  std::size_t done = 0;
  const auto at = [&](std::size_t i) -> std::uint64_t& {
    return free_slots_[group.addresses.empty() ? 0 : group.addresses[i].value];
  };
  while (done < group.rays.size() && at(done) > 0) --at(done++);
  if (done == group.rays.size()) return true;
  while (done > 0) ++at(--done);
  return false;
}

/// In order: a group that has to wait holds up those behind it.
void ShadingAgent::send_travellers(Cycle now) {
  for (; !travellers_.empty(); travellers_.pop_front()) {
    Traveller& next = travellers_.front();
    if (!reserve_slots(next.group)) {
      if (!next.counted) machine_.control.count_slot_wait();
      next.counted = true;
      return;
    }
    Cycle& port = load_free_[next.issuer];
    port = std::max(port, now) + load_cycles_ * next.group.rays.size();
    const std::uint64_t records = next.group.rays.size();
    clients_[next.issuer].new_rays->send(
        port - 1 + latency_,
        {{}, NewRays::Order::kTake, records, std::move(next.group.rays), std::move(next.group.addresses)});
  }
}

}  // namespace carousel::ringbus::cycle
