#include "ringbus/rays/ray_control.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/types/added_names.h"

namespace carousel::ringbus {

RayControlSettings ray_control_settings(const RaysConfig& rays, const CollectionsConfig& collections,
                                        const PacketsConfig& packets, const BundlesConfig& bundles,
                                        std::int32_t initial_tests, float scene_size) {
  const bool local = collections.home == Home::kLocal;
  return {
      rays.placement, local, static_cast<std::size_t>(packets.rays), initial_tests, bundles, scene_size, {}, {}, {}};
}

RayControl::RayControl(const RayControlSettings& settings, std::span<const std::unique_ptr<RayStore>> stores)
    : placement_(settings.placement),
      rule_(added_body<PlacementRule>(placement_)),
      rays_travel_(placement_ == Placement::kFirstTaker || placement_ == Placement::kAddressed),
      local_(settings.local),
      share_(settings.share),
      own_(settings.own),
      group_rays_(settings.group_rays),
      initial_tests_(settings.initial_tests),
      stores_(stores),
      slots_(std::make_unique<SlotList[]>(stores.size())),
      inboxes_(std::make_unique<Inbox[]>(stores.size())) {
  for (std::uint32_t r = 0; settings.own.empty() && r < resources(); ++r) own_.push_back(ResourceId(r));
  free_all();
  owners_.resize(settings.manager_of.empty() ? 1 : resources());
  for (const ResourceId r : own_) {
    const ResourceId manager(settings.manager_of.empty() ? 0 : settings.manager_of[r.value]);
    if (settings.manager_of.empty() || manager != r)
      owners_[manager.value].push_back(r);
    else
      managers_.push_back(manager);
  }
  if (settings.bundles.size > 0) builder_.emplace(settings.bundles, settings.scene_size);
  enough_slots_ = enough_slots();
}

/// The free slots with which a group is worth starting while all are free. Groups are placed whole where possible, but
/// waiting for more than a quarter of the slots would idle the ring.
std::size_t RayControl::enough_slots() const {
  std::size_t total = free_slots();
  // It must not be more than the packet process with the fewest slots has, or that one would get no rays.
  for (const ResourceId manager : managers_)
    if (const std::size_t own = free_slots(owners_[manager.value]); own > 0) total = std::min(total, own);
  const std::size_t issuing = share_.alone() ? own_.size() : share_.arc_size();
  return std::max<std::size_t>(1, (local_ ? total / issuing : total) / 4);
}

void RayControl::free_all() {
  for (const ResourceId r : own_) {
    SlotList& list = slots_[r.value];
    const RayStore& store = *stores_[r.value];
    list.free.clear();
    list.free_bundles.clear();
    const auto [begin, end] = own_slots(r);
    for (std::uint32_t slot = end; slot-- > begin;) list.free.push_back(slot);
    for (std::uint32_t bundle = store.room().loaded; bundle-- > 0;) list.free_bundles.push_back(store.slots() + bundle);
    list.count = list.free.size();
  }
}

/// The slots of a resource that this rank hands out, up to the second one.
std::pair<std::uint32_t, std::uint32_t> RayControl::own_slots(ResourceId resource) const {
  const std::uint32_t slots = stores_[resource.value]->slots();
  if (local_) return {0, share_.here(resource) ? slots : 0};  // rays of others never come here
  return {share_.lease_begin(slots), share_.lease_end(slots)};
}

void RayControl::discard() {
  free_all();
  for (std::uint32_t r = 0; r < resources(); ++r) {
    stores_[r]->discard();
    std::vector<RayGroup> forgotten;
    collect(ResourceId(r), forgotten);
  }
  waiting_.clear();
  waiting_bundles_.clear();
  waiting_head_ = waiting_bundles_head_ = 0;
  any_waiting_ = false;
}

std::size_t RayControl::exclude(ResourceId resource) {
  excluded_ = resource;
  std::size_t lost = 0;
  const auto close = [&](ResourceId r) {
    lost += slots_[r.value].free.size();
    slots_[r.value].free.clear();
    slots_[r.value].count = 0;
  };
  close(resource);
  // Nobody else issues packets with the rays of these.
  if (std::ranges::count(managers_, resource) > 0)
    for (const ResourceId served : owners_[resource.value]) close(served);
  enough_slots_ = enough_slots();  // of those that are left
  return lost;
}

std::size_t RayControl::free_slots() const {
  std::size_t total = 0;
  for (std::uint32_t r = 0; r < resources(); ++r) total += free_slots(ResourceId(r));
  return total;
}

ResourceId RayControl::emptiest(const std::vector<ResourceId>& of) const {
  ResourceId best = of[turn_ % of.size()];
  for (std::size_t i = 1; i < of.size(); ++i) {
    const ResourceId r = of[(turn_ + i) % of.size()];
    if (free_slots(r) > free_slots(best)) best = r;
  }
  return best;
}

std::size_t RayControl::free_slots(const std::vector<ResourceId>& of) const {
  std::size_t total = 0;
  for (const ResourceId r : of) total += free_slots(r);
  return total;
}

/// The packet process whose resources have most room; of several, that of the next turn.
ResourceId RayControl::emptiest_manager() {
  const std::size_t first = turn_++;
  ResourceId best = managers_[first % managers_.size()];
  for (std::size_t i = 1; i < managers_.size(); ++i) {
    const ResourceId manager = managers_[(first + i) % managers_.size()];
    if (free_slots(owners_[manager.value]) > free_slots(owners_[best.value])) best = manager;
  }
  return best;
}

/// The resource that a plugin's rule chooses, whether it has room or not.
ResourceId RayControl::chosen(const RayRequest& ray) {
  free_now_.clear();
  for (std::uint32_t r = 0; r < resources(); ++r) free_now_.push_back(free_slots(ResourceId(r)));
  const std::uint32_t resource = rule_->choose(ray, {free_now_, slots_used_.load(std::memory_order_relaxed)});
  if (resource >= resources())
    throw SimulationError(
        fmt::format("rays.placement: {} chose resource {} of {}", enum_name(placement_), resource, resources()));
  return ResourceId(resource);
}

std::size_t RayControl::place_by_rule(std::span<const RayRequest> rays, std::vector<RayId>& ids) {
  std::size_t placed = 0;
  for (std::uint32_t refused = 0; placed < rays.size() && refused < resources(); ++placed) {
    const std::uint32_t first = chosen(rays[placed]).value;
    for (refused = 0; refused < resources(); ++refused)
      if (load_some(ResourceId((first + refused) % resources()), rays.subspan(placed, 1), ids) == 1) break;
    if (refused == resources()) break;
  }
  return placed;
}

std::size_t RayControl::load_some(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids) {
  SlotList& list = slots_[resource.value];
  const std::lock_guard lock(list.mutex);
  const std::size_t count = std::min(rays.size(), list.free.size());
  if (!share_.here(resource)) {
    lease_some(resource, rays.first(count), ids);
    return count;
  }
  constexpr std::size_t kAhead = 8;  // records that are fetched while others are written
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) stores_[resource.value]->prefetch(list.free[list.free.size() - 1 - kAhead]);
    ids.push_back(stores_[resource.value]->load(list.free.back(), rays[i], initial_tests_));
    list.free.pop_back();
  }
  list.count.store(list.free.size(), std::memory_order_relaxed);
  slots_used_.fetch_add(count, std::memory_order_relaxed);
  return count;
}

/// Puts rays into slots of a resource that another rank plays. The resource's list is locked.
void RayControl::lease_some(ResourceId resource, std::span<const RayRequest> rays, std::vector<RayId>& ids) {
  SlotList& list = slots_[resource.value];
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ids.push_back(stores_[resource.value]->lease(list.free.back()));
    list.free.pop_back();
  }
  remote_->load(resource, std::span(ids).last(rays.size()), rays);
  list.count.store(list.free.size(), std::memory_order_relaxed);
  slots_used_.fetch_add(rays.size(), std::memory_order_relaxed);
}

std::optional<RayId> RayControl::load(ResourceId resource, const RayRequest& request) {
  std::vector<RayId> id;
  if (load_some(resource, {&request, 1}, id) == 0) return std::nullopt;
  return id.front();
}

void RayControl::free(ResourceId resource, std::span<const std::uint32_t> slots) {
  SlotList& list = slots_[resource.value];
  const std::lock_guard lock(list.mutex);
  if (!builder_)
    list.free.insert(list.free.end(), slots.begin(), slots.end());
  else
    for (const std::uint32_t slot : slots)
      (stores_[resource.value]->is_bundle(slot) ? list.free_bundles : list.free).push_back(slot);
  list.count.store(list.free.size(), std::memory_order_relaxed);
}

std::size_t RayControl::place_spread(std::span<const RayRequest> rays, const std::vector<ResourceId>& owners,
                                     std::vector<RayId>& ids) {
  if (rule_ != nullptr) return place_by_rule(rays, ids);
  std::size_t placed = 0;
  if (placement_ == Placement::kRoundRobin) {
    // One ray a resource in turn, except for full resources.
    for (std::uint32_t refused = 0; placed < rays.size() && refused < owners.size();) {
      const bool took = load_some(next_of(owners), rays.subspan(placed, 1), ids) == 1;
      refused = took ? 0 : refused + 1;
      placed += took;
    }
    return placed;
  }
  // Balanced: equal shares, each a run of neighbouring rays. The others take what full resources cannot.
  for (int pass = 0; pass < 2 && placed < rays.size(); ++pass) {
    for (std::uint32_t i = 0; i < owners.size() && placed < rays.size(); ++i) {
      const std::size_t left = owners.size() - i;
      const std::size_t share = pass == 0 ? (rays.size() - placed + left - 1) / left : rays.size() - placed;
      placed += load_some(owners[(turn_ + i) % owners.size()], rays.subspan(placed, share), ids);
    }
  }
  return placed;
}

void RayControl::queue_groups(QueueKind kind, std::size_t places) {
  for (std::uint32_t r = 0; r < resources(); ++r)
    if (share_.here(ResourceId(r))) inboxes_[r].queue = std::make_unique<PooledQueue<RayGroup>>(kind, places);
}

/// True if the next group may go to `resource`. With several ranks it may: groups are held until other ranks' data
/// come.
bool RayControl::may_send(ResourceId resource) {
  Inbox& inbox = inboxes_[resource.value];
  if (inbox.queue && inbox.next == nullptr && remote_ == nullptr) inbox.next = inbox.queue->try_take();
  return !inbox.queue || inbox.next != nullptr || remote_ != nullptr;
}

void RayControl::send(ResourceId resource, RayGroup&& group) {
  Inbox& inbox = inboxes_[resource.value];
  if (!inbox.queue) return inbox.groups.push_back(std::move(group));
  const std::size_t rays = group.rays_in();
  *inbox.next = std::move(group);
  inbox.queue->push(std::exchange(inbox.next, nullptr), rays);
}

bool RayControl::deliver(ResourceId issuer, RayGroup& group) {
  PooledQueue<RayGroup>& queue = *inboxes_[issuer.value].queue;
  RayGroup* const place = queue.try_take();
  if (place == nullptr) return false;
  const std::size_t rays = group.rays_in();
  *place = std::move(group);
  queue.push(place, rays);
  return true;
}

QueueUse RayControl::groups_sent() const {
  QueueUse sum;
  for (std::uint32_t r = 0; r < resources(); ++r)
    if (inboxes_[r].queue) sum += inboxes_[r].queue->use();
  return sum;
}

/// Places groups from the front of `rays` while there is room; returns how many rays were placed.
std::size_t RayControl::place(std::span<const RayRequest> rays) {
  if (builder_) return place_bundles(rays);
  std::size_t done = 0;
  std::uint32_t turn = turn_;  // behind the last group that found room
  while (done < rays.size()) {
    const std::span<const RayRequest> next = rays.subspan(done, std::min(group_rays_, rays.size() - done));
    RayGroup group;
    std::size_t placed = next.size();
    ResourceId issuer = managers_.empty() ? next_issuer() : emptiest_manager();
    if (rays_travel_) {
      if (!may_send(issuer)) break;
      group.rays.assign(next.begin(), next.end());
      for (std::size_t i = 0; placement_ == Placement::kAddressed && i < next.size(); ++i) {
        const std::size_t step = local_ ? 0 : i * resources() / next.size();
        const ResourceId address(static_cast<std::uint32_t>((issuer.value + step) % resources()));
        group.addresses.push_back(address == excluded_ ? issuer : address);
      }
    } else {
      if (local_ && placement_ == Placement::kBalanced) issuer = emptiest();
      if (local_ && rule_ != nullptr) issuer = chosen(next.front());
      if (local_ && rule_ != nullptr && free_slots(issuer) < std::min(next.size(), enough_slots_)) issuer = emptiest();
      const std::size_t room = local_ ? free_slots(issuer) : free_slots(owners(issuer));
      if (room < std::min(next.size(), enough_slots_)) {
        slot_waits_.fetch_add(1, std::memory_order_relaxed);
        // If resources take turns, the next one may have room.
        if (local_ && placement_ == Placement::kRoundRobin && free_slots(emptiest()) >= enough_slots_) continue;
        break;
      }
      if (!may_send(issuer)) break;
      group.ids.reserve(next.size());
      placed = local_ ? load_some(issuer, next, group.ids) : place_spread(next, owners(issuer), group.ids);
    }
    schedule_point();
    if (placed == 0) break;
    done += placed;
    turn = turn_;
    if (remote_ != nullptr)
      remote_->hold(issuer, std::move(group));
    else
      send(issuer, std::move(group));
  }
  // A group that has to wait costs no resource its turn, so it does not matter how often it is tried.
  turn_ = turn;
  return done;
}

void RayControl::submit(const RayBatch& rays) {
  const std::lock_guard lock(waiting_mutex_);
  if (builder_) return submit_bundles(rays);
  const std::size_t placed = waiting_head_ == waiting_.size() ? place(rays) : 0;
  if (placed == rays.size()) return;
  waiting_.insert(waiting_.end(), rays.begin() + static_cast<std::ptrdiff_t>(placed), rays.end());
  any_waiting_.store(true, std::memory_order_relaxed);
}

bool RayControl::place_waiting() {
  // Relaxed: only a hint; shader workers call again and again.
  if (!any_waiting_.load(std::memory_order_relaxed)) return false;
  const std::lock_guard lock(waiting_mutex_);
  return place_all_waiting();
}

bool RayControl::place_all_waiting() {
  const std::size_t placed = place(std::span(waiting_).subspan(waiting_head_));
  waiting_head_ += placed;
  if (2 * waiting_head_ >= waiting_.size()) {
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_head_));
    waiting_head_ = 0;
  }
  any_waiting_.store(!waiting_.empty(), std::memory_order_relaxed);
  return placed > 0;
}

void RayControl::collect(ResourceId resource, std::vector<RayGroup>& out) {
  Inbox& inbox = inboxes_[resource.value];
  std::move(inbox.groups.begin(), inbox.groups.end(), std::back_inserter(out));
  inbox.groups.clear();
  if (!inbox.queue) return;
  while (RayGroup* const group = inbox.queue->try_pop()) {
    out.push_back(std::exchange(*group, {}));
    inbox.queue->give_back(group);
  }
}

}  // namespace carousel::ringbus
