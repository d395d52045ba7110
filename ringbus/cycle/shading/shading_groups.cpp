// Groups of new rays that ray control has given slots: their records go to the resources, their IDs to the issuers.
#include <algorithm>

#include "ringbus/cycle/shading/shading_agent.h"

namespace carousel::ringbus::cycle {

void ShadingAgent::send_groups(Cycle now) {
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    groups_.clear();
    machine_.control.collect(ResourceId(r), groups_);
    for (RayGroup& group : groups_) {
      place_group(r, group, now);
      if (data_ && data_->keeps_records())
        data_->fetch({r, std::move(group)}, places_, now);
      else
        send_group(r, std::move(group), now);
    }
  }
}

/// The rays are in their slots from now on. Lists these in places_.
void ShadingAgent::place_group(std::uint32_t issuer, const RayGroup& group, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  places_.clear();
  for (const RayId id : group.ids) {
    const ResourceId owner = layout.owner(id);
    const RayStore& store = *machine_.stores[owner.value];
    const std::uint32_t slot = layout.slot(id);
    std::vector<Cycle>& placed_at = placed_at_[owner.value];
    std::size_t records = 1;
    places_.emplace_back(owner, slot);
    if (store.is_bundle(slot)) {
      records += store.rays_of(slot).size();
      for (const std::uint32_t ray : store.rays_of(slot)) {
        placed_at[ray] = now;
        places_.emplace_back(owner, ray);
      }
    } else {
      placed_at[slot] = now;
    }
    if (recording_.ray != nullptr) [[unlikely]]
      note_placed(id, issuer, now);
    held_[owner.value].change(now, static_cast<std::int64_t>(records));
  }
  trace_.note(now, StepKind::kPlace, 0, group.ids.size());
}

/// Loads the records, and sends the IDs when all are loaded.
void ShadingAgent::send_group(std::uint32_t issuer, RayGroup&& group, Cycle now) {
  const RayIdLayout& layout = machine_.stores.front()->layout();
  Cycle loaded = std::max(now, builder_free_);
  std::uint64_t loads = 0;
  for (const RayId id : group.ids) {
    const RayStore& store = *machine_.stores[layout.owner(id).value];
    const std::uint32_t slot = layout.slot(id);
    const std::size_t records = store.is_bundle(slot) ? 1 + store.rays_of(slot).size() : 1;
    Cycle& port = load_free_[layout.owner(id).value];
    port = std::max(port, now) + load_cycles_ * records;
    loaded = std::max(loaded, port);
    loads += records;
  }
  const Cycle arrival = id_wires_[issuer].send(4 * group.ids.size(), loaded);
  if (recording_.ray != nullptr) [[unlikely]]
    note_arrival(group.ids, arrival);
  clients_[issuer].new_rays->send(arrival, {std::move(group.ids), NewRays::Order::kTake, loads});
}

void ShadingAgent::take_ray_data(Cycle now) {
  stated_.clear();
  loaded_groups_.clear();
  data_->take(now, stated_, loaded_groups_);
  for (const RayResult& ray : stated_) to_be_shaded(ray, now);
  for (RayData::Group& group : loaded_groups_) send_group(group.issuer, std::move(group.rays), now);
}

}  // namespace carousel::ringbus::cycle
