#pragma once

#include <map>
#include <memory>
#include <random>
#include <vector>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "core/system/executor.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/protocol/deadlock.h"
#include "ringbus/resource/resource.h"
#include "ringbus/topology/topology.h"
#include "scene/builtin/builtin.h"
#include "tests/accel/traverse/brute_force.h"

namespace carousel::ringbus {

/// Resources without an engine: the test moves the packets, in any order.
struct MockRing {
  Config config;
  accel::Accel accel;
  std::vector<std::unique_ptr<RayStore>> stores;
  std::vector<std::unique_ptr<StatisticsSink>> sinks;
  std::vector<std::unique_ptr<Resource>> resources;
  std::vector<std::vector<std::uint32_t>> free_slots;

  MockRing(const Config& c, const scene::Scene& scene)
      : config(c), accel(accel::build(scene, c.bvh, *make_sequential_executor())) {
    if (config.collections.when_full == WhenFull::kReserve)
      config.collections.capacity =
          std::max(config.packets.rays, minimum_capacity(config, accel.most_ways(), accel.levels()));
    for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(c.topology.resources); ++r) {
      stores.push_back(
          std::make_unique<RayStore>(ResourceId(r), static_cast<std::uint32_t>(c.rays.slots_per_resource)));
      sinks.push_back(std::make_unique<StatisticsSink>());
      resources.push_back(
          std::make_unique<Resource>(settings(), accel, *stores.back(), ResourceHooks{.events = sinks.back().get()}));
      free_slots.emplace_back();
      for (std::uint32_t s = stores.back()->slots(); s-- > 0;) free_slots.back().push_back(s);
    }
  }

  ResourceSettings settings() const { return resource_settings(config, 10.0f); }
  RayId load(std::uint32_t resource, const RayRequest& request) {
    const std::uint32_t slot = free_slots[resource].back();
    free_slots[resource].pop_back();
    return stores[resource]->load(slot, request, Resource::initial_tests(settings(), accel));
  }
  Packet packet() const {
    Packet p;
    p.owners.resize((resources.size() + 63) / 64);
    return p;
  }
  const RayRecord& record(RayId id) {
    RayStore& store = *stores[stores[0]->layout().owner(id).value];
    return store.record(store.layout().slot(id));
  }
  /// Takes completed rays and their slots away from a resource.
  HitBatch take_completed(std::uint32_t resource) {
    Resource& r = *resources[resource];
    free_slots[resource].insert(free_slots[resource].end(), r.freed_slots().begin(), r.freed_slots().end());
    r.freed_slots().clear();
    HitBatch done;
    done.swap(r.completed());
    return done;
  }
};

}  // namespace carousel::ringbus
