#include "ringbus/ray_control.h"

#include <algorithm>
#include <iterator>

namespace carousel::ringbus {

RayControl::RayControl(const Config& config)
    : placement_(config.rays.placement),
      rays_travel_(placement_ == Placement::kFirstTaker || placement_ == Placement::kAddressed),
      group_rays_(static_cast<std::size_t>(config.packets.rays)),
      slots_(config.rays.slots_per_resource),
      resources_(static_cast<std::uint32_t>(config.topology.resources)),
      inboxes_(std::make_unique<Inbox[]>(resources_)) {}

ResourceId RayControl::choose() {
  if (placement_ != Placement::kBalanced) return ResourceId(turn_.fetch_add(1, std::memory_order_relaxed) % resources_);
  // Starting from a different resource each time breaks ties fairly.
  const std::uint32_t start = turn_.fetch_add(1, std::memory_order_relaxed) % resources_;
  ResourceId best(start);
  for (std::uint32_t i = 1; i < resources_; ++i) {
    const ResourceId r((start + i) % resources_);
    if (load_of(r) < load_of(best)) best = r;
  }
  return best;
}

void RayControl::submit(const RayBatch& rays) {
  for (std::size_t begin = 0; begin < rays.size(); begin += group_rays_) {
    const std::size_t count = std::min(group_rays_, rays.size() - begin);
    const ResourceId target = choose();
    RayGroup group;
    group.rays.assign(rays.begin() + static_cast<std::ptrdiff_t>(begin),
                      rays.begin() + static_cast<std::ptrdiff_t>(begin + count));
    if (placement_ == Placement::kAddressed) {
      // Neighbouring rays stay together: each resource is sent one run of the group.
      for (std::size_t i = 0; i < count; ++i)
        group.addresses.emplace_back(static_cast<std::uint32_t>((target.value + i * resources_ / count) % resources_));
    }
    Inbox& inbox = inboxes_[target.value];
    if (!rays_travel_) inbox.load.fetch_add(static_cast<std::int64_t>(count), std::memory_order_relaxed);
    const std::lock_guard lock(inbox.mutex);
    inbox.groups.push_back(std::move(group));
    // Relaxed: only a hint that the lock is worth taking; the mutex publishes the group.
    inbox.any.store(true, std::memory_order_relaxed);
  }
}

void RayControl::collect(ResourceId resource, std::vector<RayGroup>& out) {
  Inbox& inbox = inboxes_[resource.value];
  if (!inbox.any.load(std::memory_order_relaxed)) return;
  const std::lock_guard lock(inbox.mutex);
  std::move(inbox.groups.begin(), inbox.groups.end(), std::back_inserter(out));
  inbox.groups.clear();
  inbox.any.store(false, std::memory_order_relaxed);
}

bool RayControl::has_room(const ResourceId* address) const {
  if (address != nullptr) return load_of(*address) < slots_;
  for (std::uint32_t r = 0; r < resources_; ++r)
    if (load_of(ResourceId(r)) < slots_) return true;
  return false;
}

}  // namespace carousel::ringbus
