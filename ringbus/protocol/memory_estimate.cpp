#include "ringbus/protocol/memory_estimate.h"

#include <algorithm>

#include "core/config/own_sections.h"
#include "core/types/workload.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/storage_rule.h"
#include "ringbus/resource/traversal/make_traversal.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

namespace {

std::uint64_t worker_caches(const Config& config) {
  const ShadingConfig& shading = config.shading;
  if (!shading.program.any() || config.engine.kind != EngineKind::kCycle) return 0;
  constexpr std::int64_t kInstructionLine = 16, kName = 8, kSet = 24;
  const std::int64_t line = shading.data_cache.line_bytes.value_or(config.memory.line_bytes);
  const std::int64_t lines = shading.data_cache.bytes / line, sets = lines / shading.data_cache.ways;
  const std::int64_t pages = shading.translation.page_bytes > 0 ? shading.translation.entries : 0;
  const InstructionCacheConfig& instructions = shading.instruction_cache;
  return static_cast<std::uint64_t>(
      shader_workers(config) *
      (instructions.bytes / instructions.line_bytes * kInstructionLine + (lines + pages) * kName + sets * kSet));
}

}  // namespace

MemoryEstimate estimate_memory(const Config& config, int max_depth, bool gaussians) {
  const auto u = [](std::int64_t x) { return static_cast<std::uint64_t>(x); };
  const std::uint64_t resources = u(config.topology.resources), slots = u(all_slots(config));
  const std::uint64_t packet_rays = u(config.packets.rays);
  const bool ordered = one_collection_a_ray(config.collections.traversal);
  const std::uint64_t next = ordered ? sizeof(NextNode) : 0;
  MemoryEstimate e;
  e.ray_store = slots * (sizeof(RayRecord) + 2 * sizeof(std::uint32_t));
  const QueryConfig& query = config.rays.query;
  if (query.nearest > 0)
    e.ray_store += slots * (sizeof(accel::NearestRay) +
                            u(query.buffered() + (query.in_rounds() && !gaussians ? query.nearest : 0)) * sizeof(Hit));
  if (config.bundles.size > 0) {
    const auto records = [&](const OwnSections& one) {
      const BundleRoom room = bundle_room(config.bundles, one.rays.slots_per_resource);
      return std::int64_t{room.loaded} + room.own;
    };
    e.ray_store += u(sum_of_resources(config, records)) *
                   (sizeof(accel::BundleRecord) + (u(config.bundles.size) + 2) * sizeof(std::uint32_t));
  }
  const Topology topology(config.topology);
  if (ordered || !topology.has_packets()) {
    const std::uint64_t entries = u(config.bvh.width - 1) * u(max_depth) + 1;
    e.ray_stacks = slots * (entries * sizeof(NextNode) + sizeof(std::uint16_t));
  }
  // A completed ray may cause two, and both wait while slots are taken.
  e.rays_waiting = slots * (2 * sizeof(RayRequest) + sizeof(RayResult));
  e.worker_caches = worker_caches(config);
  if (!topology.has_packets()) return e;
  // An ID, and a block's share of a collection, its place in the table and its list links.
  const std::uint64_t block = u(block_rays(config.collections, config.packets));
  const auto blocks = [&](const OwnSections& one) {
    const std::uint64_t own = u(one.collections.capacity) / block + 1;
    return static_cast<std::int64_t>(ordered ? std::min(own, slots) : own);
  };
  e.collections = u(sum_of_resources(config, blocks)) * (block * sizeof(RayId) + 128);
  const std::uint64_t packets = resources * topology.directions() * topology.packets_in_flight() + resources;
  const std::uint64_t copies = topology.broadcasts() ? 1 + resources : 1;  // with those that are answers
  e.packets = copies * packets * (sizeof(Packet) + packet_rays * (sizeof(PacketMember) + next));
  return e;
}

}  // namespace carousel::ringbus
