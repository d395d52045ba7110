#include "ringbus/cycle/shading/ray_placement.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

RayPlacement::RayPlacement(Machine& machine, RayControl& control, const ShadingSettings& settings,
                           const std::vector<SidePorts>& clients, ShadingRecorder& recorder, Trace& trace)
    : machine_(machine),
      control_(control),
      clients_(clients),
      recorder_(recorder),
      trace_(trace),
      gather_(settings.packet_rays),
      bundled_(settings.bundles.size > 0),
      builder_rate_(static_cast<Cycle>(settings.bundles.builder.rays_per_cycle)),
      ports_(settings.link, clients.size()),
      id_wires_(clients.size(), SideWire(settings.link, control_latency(settings.link))),
      slots_(machine) {
  if (control.rays_travel()) travelling_ = std::make_unique<TravellingGroups>(machine, settings, clients, ports_);
  const std::size_t open = static_cast<std::size_t>(settings.bundles.size * settings.bundles.builder.open);
  if (bundled_) gather_ = std::max(gather_, std::min(settings.slots / 4, open));
}

/// Hands rays to ray control, through the builder of bundles if there is one.
void RayPlacement::submit(const RayBatch& rays, Cycle now) {
  if (bundled_) builder_free_ = std::max(builder_free_, now) + ceil_div(rays.size(), builder_rate_);
  control_.submit(rays);
}

void RayPlacement::place_again(const RayBatch& rays, Cycle now) {
  submit(rays, now);
  send_groups(now);
}

void RayPlacement::send_placed(bool placed, Cycle now) {
  if (!travelling_) {
    if (placed) send_groups(now);
    return;
  }
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    groups_.clear();
    control_.collect(ResourceId(r), groups_);
    for (const RayGroup& group : groups_) travelling_->add(r, group);
  }
  travelling_->send(now);
}

void RayPlacement::send_groups(Cycle now) {
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    groups_.clear();
    control_.collect(ResourceId(r), groups_);
    for (RayGroup& group : groups_) {
      place_group(r, group, now);
      if (data_ != nullptr && data_->keeps_records())
        data_->fetch({r, std::move(group)}, places_, now);
      else
        send_group(r, std::move(group), now);
    }
  }
}

/// The rays are in their slots from now on. Lists these in places_.
void RayPlacement::place_group(std::uint32_t issuer, const RayGroup& group, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  places_.clear();
  for (const RayId id : group.ids) {
    const ResourceId owner = layout.owner(id);
    const RayStore& store = *machine_.stores[owner.value];
    const std::uint32_t slot = layout.slot(id);
    std::size_t records = 1;
    places_.emplace_back(owner, slot);
    if (store.is_bundle(slot)) {
      records += store.rays_of(slot).size();
      for (const std::uint32_t ray : store.rays_of(slot)) {
        slots_.placed(owner, ray, now);
        places_.emplace_back(owner, ray);
      }
    } else {
      slots_.placed(owner, slot, now);
    }
    recorder_.placed(id, issuer, now);
    slots_.taken(owner, records, now);
  }
  trace_.note(now, StepKind::kPlace, 0, group.ids.size());
}

void RayPlacement::send_group(std::uint32_t issuer, RayGroup&& group, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  Cycle loaded = std::max(now, builder_free_);
  std::uint64_t loads = 0;
  for (const RayId id : group.ids) {
    const RayStore& store = *machine_.stores[layout.owner(id).value];
    const std::uint32_t slot = layout.slot(id);
    const std::size_t records = store.is_bundle(slot) ? 1 + store.rays_of(slot).size() : 1;
    loaded = std::max(loaded, ports_.load(layout.owner(id).value, records, now));
    loads += records;
  }
  const Cycle arrival = id_wires_[issuer].send(4 * group.ids.size(), loaded);
  recorder_.sent(group.ids, arrival);
  clients_[issuer].new_rays->send(arrival, {std::move(group.ids), NewRays::Order::kTake, loads});
}

void RayPlacement::free(std::uint32_t resource, const CompletedRays& done, Cycle now) {
  if (travelling_) {
    travelling_->freed(resource, done.slots.size());
    for (const Cycle placed : done.placed) slots_.came_back(placed, now);
  } else {
    control_.free(ResourceId(resource), done.slots);
    slots_.freed(ResourceId(resource), done.slots, now);
  }
}

void RayPlacement::order_all(NewRays::Order order, Cycle now) {
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    const NewRays message{{}, order, 0};
    clients_[r].new_rays->send(id_wires_[r].send(message.bytes(), now), message);
  }
}

}  // namespace carousel::ringbus::cycle
