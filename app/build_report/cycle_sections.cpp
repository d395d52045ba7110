#include "app/build_report/cycle_sections.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "app/build_report/memory_report.h"
#include "app/build_report/ring_sections.h"
#include "core/config/own_sections.h"
#include "core/config/shader_programs.h"
#include "report/csv/ray_csv_columns.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/results/run_features.h"
#include "ringbus/topology/topology.h"
#include "ringbus/verdict/steady_state.h"

namespace carousel::app {

using report::ratio;

namespace {

report::Rate rate(double rays, std::uint64_t cycles, std::int64_t clock_mhz) {
  const double per_cycle = ratio(rays, static_cast<double>(cycles));
  return {1000 * per_cycle, per_cycle * static_cast<double>(clock_mhz)};
}

report::ShaderPrograms shader_programs(const ShadingCounts& counts, const Config& config) {
  const ShadePrograms programs = shade_programs(config.shading, config.programs, config.testers);
  const ShadeProgramCounts& of = counts.programs;
  const bool cached = config.shading.data_cache.bytes > 0 || config.shading.translation.page_bytes > 0;
  const std::uint64_t held = vectors_held(config.shading, programs);
  return {of,
          programs.registers,
          held,
          programs.store_bytes,
          ratio(of.vector_cycles, counts.busy * held),
          ratio(of.lane_instructions(), of.issued * static_cast<std::uint64_t>(config.shading.lanes)),
          ratio(of.issued, counts.busy),
          cached ? std::optional(counts.data) : std::nullopt};
}

report::UnitCycles unit_cycles(const ringbus::cycle::BankUse& use, const ringbus::cycle::TileResult& tile) {
  using ringbus::cycle::TileState;
  const auto in = [&](TileState state) {
    const auto i = static_cast<std::size_t>(state);
    return tile.states[i] - use.busy_in[i];
  };
  constexpr auto kTesting = static_cast<std::size_t>(TileState::kTesting);
  return {.busy = use.busy,
          .other_units = tile.testing.any - use.busy_in[kTesting],
          .latency = tile.testing.latency,
          .passing = tile.states[kTesting] - tile.testing.any - tile.testing.latency,
          .memory = in(TileState::kMemory),
          .link = in(TileState::kLink),
          .credits = in(TileState::kCredits),
          .storage = in(TileState::kStorage),
          .shading = in(TileState::kShading),
          .idle = in(TileState::kIdle)};
}

report::Warps warps(const ringbus::cycle::TileResult& tile) {
  report::Warps out{tile.warp_lanes, *tile.warps, {}};
  for (const LaneUse& use : tile.bounces) out.bounces.push_back({out.bounces.size(), use});
  return out;
}

report::Units units(const ringbus::cycle::TileResult& tile, std::uint64_t cycles, const Config& config,
                    const accel::Accel& accel) {
  report::Units out;
  out.features = ringbus::features_of(config, accel);
  for (const auto [kind, use] : tile.units) out.kinds[kind] = unit_cycles(use, tile);
  const auto has_lanes = [](const OwnOf& one) { return one.testers != nullptr && one.testers->simd.lanes > 1; };
  if (config.testers.simd.lanes > 1 || any_own(config.topology, has_lanes)) {
    report::LaneFill& fill = out.lane_fill.emplace();
    for (const auto [kind, use] : tile.units)
      if (use.lanes > 0) fill.kinds[kind] = ratio(use.passes, use.lanes);
  }
  for (const auto [kind, use] : tile.units)
    if (use.busy > 0) out.unit_fill.kinds[kind] = use.fill;
  if (config.rays.banks > 0) {
    out.bank_conflicts = tile.bank_conflicts;
    out.second_reads = tile.second_reads;
    out.primitive_ray_reads = unit_cycles(tile.primitive_ray_reads, tile);
  }
  const auto bounds_reads = [](const OwnOf& one) { return one.keys->reads_per_cycle.value_or(0) > 0; };
  if (config.rays.reads_per_cycle > 0 || config.rays.banks > 0 || any_own(config.topology, bounds_reads))
    out.ray_reads = unit_cycles(tile.ray_reads, tile);
  out.distributor = tile.distributor;
  if (tile.warps) out.warps = warps(tile);
  out.dispatch_busy = tile.dispatch.busy;
  out.dispatch_idle = cycles - tile.dispatch.busy;
  return out;
}

void add_to_resource(report::Resource& out, const ringbus::cycle::TileResult& tile, std::uint64_t cycles,
                     const Config& config, const accel::Accel& accel) {
  out.units = units(tile, cycles, config, accel);
  if (!ringbus::Topology(config.topology).has_packets()) out.stack = tile.stack;
  if (config.accuracy.transformed_ray == AccuracyConfig::TransformedRay::kStore)
    out.transformed_rays = tile.transformed_rays;
}

void add_to_link(report::Link& out, const ringbus::cycle::LinkUse& link, std::uint64_t cycles) {
  out.utilisation = ratio(link.use.busy, cycles);
  out.occupancy_mean = ratio(link.queue.packet_cycles, cycles);
  out.occupancy_max = link.queue.most;
  out.stalled = link.use.stalled;
  out.bytes = link.bytes;
  out.cycles = report::LinkCycles{link.use.busy, link.use.stalled, cycles - link.use.busy - link.use.stalled};
}

report::Memory memory(const ringbus::cycle::CycleResult& c, const MemoryConfig& config) {
  report::Memory out;
  for (const ringbus::cycle::TileResult& tile : c.tiles) out.shape_buffers.counts += tile.shapes;
  const std::uint64_t port_cycles = c.cycles * static_cast<std::uint64_t>(config.l2_banks);
  for (const CacheCounts& cache : c.caches) out.caches.push_back({cache, ratio(cache.port_busy, port_cycles), {}});
  for (std::size_t i = 0; i < c.fetched_ahead.size(); ++i) out.caches[i].ahead = c.fetched_ahead[i];
  if (c.own_caches) out.own_caches = {*c.own_caches, ratio(c.own_caches->port_busy, c.cycles * c.tiles.size()), {}};
  out.counts = c.memory;
  out.dram_utilisation = ratio(c.memory.busy, c.cycles * c.memories);
  out.ray_data = c.ray_data;
  out.triangle_strips = c.strips;
  if (c.blocks) out.triangle_blocks = {*c.blocks, c.structure_bytes};
  if (config.l2_write == MemoryConfig::Write::kBack) out.drain = c.drain;
  if (c.dram) out.dram = dram_section(*c.dram);
  return out;
}

std::vector<report::WorkerPool> pools(const ringbus::cycle::CycleResult& c, const Config& config) {
  const ringbus::ParcelPlan plan = ringbus::plan_parcels(config.topology, config.memory.line_bytes);
  const std::vector<std::int64_t> workers = pool_workers(config);
  std::vector<report::WorkerPool> out;
  for (std::size_t i = 0; i < c.pools.size(); ++i) {
    report::WorkerPool& pool = out.emplace_back(report::WorkerPool{plan.graph.nodes[plan.parts.pools[i]].name});
    pool.resources = static_cast<std::uint64_t>(std::ranges::count(plan.parts.pool_of, i));
    pool.workers = static_cast<std::uint64_t>(workers[i]);
    pool.shaded = c.pools[i].shaded;
    pool.utilisation = ratio(c.pools[i].busy, c.cycles * pool.workers);
  }
  return out;
}

}  // namespace

void add_cycles(report::Report& r, const ringbus::cycle::CycleResult& c, const Config& config,
                const accel::Accel& accel) {
  r.engine.cycles = c.cycles;
  add_clocks(r, config);
  report::Epochs& epochs = r.engine.epochs.emplace();
  epochs.cycles_each = c.epochs.cycles_each;
  for (const std::uint64_t digest : c.epochs.digests) epochs.digests.push_back(fmt::format("{:016x}", digest));
  if (r.throughput) {
    const double rays = static_cast<double>(r.rays.completed);
    r.throughput->whole = rate(rays, c.cycles, config.engine.clock_mhz);
    const auto slots = static_cast<std::uint64_t>(all_slots(config));
    if (const auto steady = ringbus::steady_state(c, r.rays.completed, slots))
      r.throughput->steady = rate(rays * steady->share, steady->cycles, config.engine.clock_mhz);
  }
  for (std::size_t i = 0; r.resources && i < r.resources->size(); ++i)
    add_to_resource((*r.resources)[i], c.tiles[i], c.cycles, config, accel);
  if (const auto& stops = c.stops)
    r.stops = report::RingStopsUse{stops->extra_rounds, stops->longest_ride, stops->longest_wait, stops->reservations,
                                   stops->starts};
  const bool clocks = several_clocks(config);
  for (std::size_t i = 0; r.links && i < r.links->size(); ++i) {
    add_to_link((*r.links)[i], c.links[i], c.cycles);
    if (clocks) (*r.links)[i].clock = clock_of_link(config, c.links[i].mhz);
  }
  r.rays.residence = report::distribution_of(c.residence);
  if (c.ray_times) {
    report::RayTime& time = r.ray_time.emplace();
    for (const ringbus::RayTimeRow& row : *c.ray_times)
      time.by_kind.push_back(
          {std::string(report::kRayKindNames[static_cast<std::size_t>(row.kind)]), row.bounce, row.rays, row.stages});
  }
  Log2Histogram ages;
  for (const ringbus::cycle::TileResult& tile : c.tiles) ages += tile.collection_ages;
  if (r.collections && ages.count() > 0) r.collections->age = report::distribution_of(ages);
  LatencyHistogram trips;
  for (const ringbus::cycle::TileResult& tile : c.tiles) trips.add(tile.round_trips);
  PacketKindCounts sent;
  for (const ringbus::cycle::TileResult& tile : c.tiles) sent += tile.sent;
  if (r.packets) r.packets->sent = sent;
  if (r.packets && trips.count() > 0) r.packets->latency = report::latency_of(trips);
  if (r.collections && properties_of(config.topology).has_packets && config.collections.when_full == WhenFull::kSpill) {
    SpillBytes& spill = r.collections->spill.emplace();
    for (const ringbus::cycle::TileResult& tile : c.tiles) spill += tile.spilled;
  }
  if (r.collections && c.ids) {
    r.collections->ids_at_once = c.ids->most;
    r.collections->ids_interval = c.ids->interval;
  }
  r.memory = memory(c, config.memory);
  r.parts = c.parts;
  r.bytes = c.bytes;
  if (!config.shading.program.any()) {  // whose instructions are these
    r.shading.products = c.shading.products;
    r.shading.lookups = c.shading.lookups;
  }
  if (const ShadeVectorCounts& of = c.shading.vectors; config.shading.lanes > 1)
    r.shading.vectors = {of, ratio(of.rays, of.runs * static_cast<std::uint64_t>(config.shading.lanes)),
                         ratio(of.runs, of.vectors)};
  if (config.shading.program.any()) r.shading.programs = shader_programs(c.shading, config);
  r.shading.utilisation = ratio(c.shading.busy, c.cycles * static_cast<std::uint64_t>(shader_workers(config)));
  if (c.pools.size() > 1) r.shading.pools = pools(c, config);
}

}  // namespace carousel::app
