// Ray control with bundles: the builder stands between shading and the slots (US 11308683, fig. 8).
#include <algorithm>
#include <stdexcept>

#include "ringbus/rays/ray_control.h"

namespace carousel::ringbus {

// Bundles are made once, of the rays of one batch. Bundles that find no slots wait as they are.
void RayControl::submit_bundles(const RayBatch& rays) {
  order_.clear();
  sizes_.clear();
  builder_->group(rays, order_, sizes_);
  for (const std::uint32_t i : order_) waiting_.push_back(rays[i]);
  waiting_bundles_.insert(waiting_bundles_.end(), sizes_.begin(), sizes_.end());
  any_waiting_.store(!waiting_.empty(), std::memory_order_relaxed);
  place_all_waiting();
}

std::size_t RayControl::load_bundle(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids) {
  const std::size_t first = ids.size();
  if (load_some(resource, rays, ids) < rays.size()) throw std::logic_error("fewer free slots than were counted");
  if (rays.size() == 1) return 1;
  RayStore& store = *stores_[resource.value];
  SlotList& list = slots_[resource.value];
  const std::lock_guard lock(list.mutex);
  if (list.free_bundles.empty()) return rays.size();  // each on its own
  members_.clear();
  for (std::size_t i = first; i < ids.size(); ++i) {
    members_.push_back(store.layout().slot(ids[i]));
    store.record(members_.back()).pending = 1;  // the bundle's, until it dissolves
  }
  ids.resize(first);
  ids.push_back(store.make_bundle(list.free_bundles.back(), members_, static_cast<std::int16_t>(initial_tests_)));
  list.free_bundles.pop_back();
  return rays.size();
}

/// Places whole bundles from the front of the waiting ones; returns how many rays were placed.
std::size_t RayControl::place_bundles(std::span<const RayRequest> rays) {
  std::size_t done = 0, bundle = waiting_bundles_head_;
  bool room = true;
  while (room && bundle < waiting_bundles_.size()) {
    // As with single rays, a group waits for room for all of it, or for as much as is worth starting with.
    std::size_t wanted = 0;
    for (std::size_t i = bundle; i < std::min(bundle + group_rays_, waiting_bundles_.size()); ++i)
      wanted += waiting_bundles_[i];
    const std::uint32_t turn = turn_;
    ResourceId issuer = !managers_.empty()                             ? emptiest_manager()
                        : local_ && placement_ == Placement::kBalanced ? emptiest()
                                                                       : next_resource();
    if (local_ && rule_ != nullptr) issuer = chosen(rays[done]);
    if (local_ && rule_ != nullptr && free_slots(issuer) < std::min(wanted, enough_slots_)) issuer = emptiest();
    const std::vector<ResourceId>& owners = this->owners(issuer);
    if ((local_ ? free_slots(issuer) : free_slots(owners)) < std::min(wanted, enough_slots_)) {
      slot_waits_.fetch_add(1, std::memory_order_relaxed);
      if (local_ && placement_ == Placement::kRoundRobin && free_slots(emptiest()) >= std::min(wanted, enough_slots_))
        continue;
      turn_ = turn;  // a group that has to wait costs no resource its turn
      break;
    }
    if (!may_send(issuer)) {
      turn_ = turn;
      break;
    }
    RayGroup group;
    while (group.ids.size() < group_rays_ && bundle < waiting_bundles_.size()) {
      const std::size_t size = waiting_bundles_[bundle];
      ResourceId owner = local_                               ? issuer
                         : rule_ != nullptr                   ? chosen(rays[done])
                         : placement_ == Placement::kBalanced ? emptiest(owners)
                                                              : next_of(owners);
      if (!local_ && free_slots(owner) < size) owner = emptiest(owners);
      if (free_slots(owner) < size) {
        room = false;
        break;
      }
      done += load_bundle(owner, rays.subspan(done, size), group.ids);
      ++bundle;
      schedule_point();
    }
    if (group.ids.empty())
      turn_ = turn;
    else
      send(issuer, std::move(group));
  }
  waiting_bundles_head_ = bundle;
  if (2 * bundle >= waiting_bundles_.size()) {
    waiting_bundles_.erase(waiting_bundles_.begin(), waiting_bundles_.begin() + static_cast<std::ptrdiff_t>(bundle));
    waiting_bundles_head_ = 0;
  }
  return done;
}

}  // namespace carousel::ringbus
