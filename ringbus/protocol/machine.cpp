#include "ringbus/protocol/machine.h"

#include <algorithm>

#include "core/config/own_sections.h"
#include "ringbus/protocol/packet_pool.h"
#include "ringbus/resource/resource.h"
#include "ringbus/resource/traversal/make_traversal.h"

namespace carousel::ringbus {

namespace {

RayControlSettings control_settings(const Config& config, const accel::Accel& accel, float scene_size,
                                    const Topology& topology, const RankShare& share) {
  const std::int32_t tests = Resource::initial_tests(resource_settings(config, scene_size), accel);
  RayControlSettings settings =
      ray_control_settings(config.rays, config.collections, config.packets, config.bundles, tests, scene_size);
  settings.local |= !topology.has_packets();
  settings.share = share;
  settings.manager_of = topology.manager_of();
  return settings;
}

std::vector<std::int64_t> slots_of_resources(const Config& config) {
  std::vector<std::int64_t> slots(static_cast<std::size_t>(config.topology.resources), config.rays.slots_per_resource);
  for (std::size_t r = 0; r < slots.size(); ++r)
    slots[r] = own_sections(config, static_cast<std::int64_t>(r)).rays.slots_per_resource;
  return slots;
}

}  // namespace

Machine::Machine(const Config& config, const accel::Accel& a, float scene_size,
                 std::optional<std::uint32_t> local_packets, const RankShare& rank_share)
    : accel(a),
      share(rank_share),
      topology(config.topology),
      flow(config.topology.flow, topology.room_for_all()),
      home_local(config.collections.home == Home::kLocal),
      stays(home_local || topology.resources() == 1),
      own_rays_last(config.testers.own_rays == TestersConfig::OwnRays::kAfter),
      packets_per_direction(stays && topology.has_packets() ? local_packets.value_or(topology.packets_in_flight())
                                                            : topology.packets_in_flight()),
      packets(make_packets(topology, packets_per_direction, static_cast<std::size_t>(config.packets.rays),
                           one_collection_a_ray(config.collections.traversal))),
      answers(topology.broadcasts() && !stays ? topology.resources() : 0, std::vector<Packet>(packets.size())),
      stores(make_ray_stores(slots_of_resources(config), config.bundles, share)),
      control(control_settings(config, accel, scene_size, topology, share), stores) {
  if (config.rays.query.nearest == 0) return;
  for (const auto& store : stores) store->find_nearest(config.rays.query, accel);
}

void Machine::divide_control(const Config& config, float scene_size, const std::vector<std::size_t>& of) {
  pool_of = of;
  RayControlSettings settings = control_settings(config, accel, scene_size, topology, share);
  for (std::size_t pool = 0; pool <= *std::ranges::max_element(of); ++pool) {
    settings.own.clear();
    for (std::uint32_t r = 0; r < of.size(); ++r)
      if (of[r] == pool) settings.own.push_back(ResourceId(r));
    pools.push_back(std::make_unique<RayControl>(settings, stores));
  }
}

std::uint64_t Machine::slots_used() const {
  std::uint64_t sum = control.slots_used();
  for (const auto& pool : pools) sum += pool->slots_used();
  return sum;
}

std::uint64_t Machine::slot_waits() const {
  std::uint64_t sum = control.slot_waits();
  for (const auto& pool : pools) sum += pool->slot_waits();
  return sum;
}

std::optional<NearestResult> Machine::nearest() const {
  std::optional<NearestResult> out;
  for (const auto& store : stores) {
    if (store->nearest() == nullptr) continue;
    if (!out) out.emplace();
    out->use += store->nearest()->use();
    out->digest.add(store->nearest()->digest());
  }
  return out;
}

}  // namespace carousel::ringbus
