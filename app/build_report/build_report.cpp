#include "app/build_report/build_report.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "accel/traverse/kernels.h"
#include "app/build_report/effects.h"
#include "app/host/machine_info.h"
#include "app/host/program_info.h"
#include "core/config/enum_names.h"
#include "core/config/write.h"
#include "report/text/ratio.h"

namespace carousel::app {

using report::ratio;

namespace {

report::SceneSummary summary(const Prepared& p) {
  const scene::Scene& s = p.scene;
  report::SceneSummary out;
  out.name = s.name;
  out.triangles = s.unique_triangle_count();
  out.instanced_triangles = s.instanced_triangle_count();
  out.meshes = s.meshes.size();
  out.instances = s.instances.size();
  out.materials = s.materials.size();
  out.textures = s.textures.size();
  out.lights = s.lights.size();
  out.cameras = s.cameras.size();
  if (const Aabb box = s.bounds(); !box.empty()) {
    for (int axis = 0; axis < 3; ++axis) {
      out.bounds.lo[static_cast<std::size_t>(axis)] = shortest(box.lo[axis]);
      out.bounds.hi[static_cast<std::size_t>(axis)] = shortest(box.hi[axis]);
    }
  }
  out.warnings = p.warnings;
  return out;
}

report::Tests tests(const IntersectionCounts& counts, std::uint64_t rays) {
  const auto kind = [&](std::uint64_t count) { return report::TestKind{count, ratio(count, rays)}; };
  return {kind(counts.box),        kind(counts.plane),      kind(counts.triangle), kind(counts.bundle),
          kind(counts.transforms), kind(counts.inversions), kind(counts.culled)};
}

report::BundleTests bundle_tests(const ringbus::BundleCounts& c, std::size_t depth) {
  const auto difference = [](std::uint64_t a, std::uint64_t b) {
    return static_cast<std::int64_t>(a) - static_cast<std::int64_t>(b);
  };
  return {depth,
          c.all,
          c.none,
          c.split,
          c.lane_rays - c.split_rays,
          difference(c.visit_rays, c.visits + c.touched + c.taken_apart)};
}

report::Bundles bundles(const std::vector<ringbus::BundleCounts>& by_depth) {
  report::Bundles out;
  ringbus::BundleCounts sum;
  for (std::size_t depth = 0; depth < by_depth.size(); ++depth) {
    sum += by_depth[depth];
    out.by_depth.push_back(bundle_tests(by_depth[depth], depth));
  }
  out.sum = bundle_tests(sum, by_depth.size() - 1);
  out.formed = sum.formed;
  out.rays_mean = ratio(sum.formed_rays, sum.formed);
  out.ray_bytes_spared = out.sum.ray_reads_spared * static_cast<std::int64_t>(sizeof(RayRecord));
  return out;
}

report::CullPlanes cull_planes(const accel::Accel& accel, const CullCounts& culls) {
  report::CullPlanes out{accel.planes.size(), accel.plane_bytes, ratio(accel.plane_bytes, accel.nodes.size())};
  const auto add = [&](const char* structure, const auto& levels) {
    for (std::size_t depth = 0; depth < levels.size(); ++depth) {
      const CullLevel& level = levels[depth];
      if (level.children > 0)
        out.levels.push_back({structure, depth, level.children, level.plane_tests, level.culled(), level.boxes,
                              level.nodes, level.leaves, level.triangles, level.transforms});
    }
  };
  add("top", culls.above);
  add("bottom", culls.below);
  return out;
}

report::Resource resource(std::size_t number, const ringbus::ResourceStatistics& s,
                          const ringbus::CollectionStore::Statistics& c) {
  using ringbus::StallReason;
  const auto stalls = [&](StallReason reason) { return s.stalls[static_cast<std::size_t>(reason)]; };
  report::Resource out;
  out.resource = number;
  out.rays_admitted = s.rays_admitted;
  out.rays_completed = s.rays_completed;
  out.packets_issued = s.packets_issued;
  out.packets_retired = s.packets_retired;
  out.packets_seen = s.visits;
  out.bubbles = s.bubbles;
  out.hops = s.hops;
  out.rays_tested = s.local_rays;
  out.box_tests = s.tests.box;
  out.triangle_tests = s.tests.triangle;
  out.transforms = s.tests.transforms;
  out.collections_created = c.created;
  out.collections_peak = c.peak;
  out.memberships_peak = c.memberships_peak;
  out.spilled = c.spilled;
  out.stalls = {stalls(StallReason::kCredits), stalls(StallReason::kLink), stalls(StallReason::kSlots),
                stalls(StallReason::kStorage), stalls(StallReason::kReserve)};
  return out;
}

/// The parts that come from the resources' event counts.
void add_ring(report::Report& r, const ringbus::RunResult& result, const PacketsConfig& config,
              const accel::Accel& accel) {
  const std::uint64_t rays = result.rays_completed;
  ringbus::ResourceStatistics sum;
  report::Collections collections;
  r.resources.emplace();
  for (std::size_t i = 0; i < result.resources.size(); ++i) {
    const ringbus::CollectionStore::Statistics& c = result.collections[i];
    sum += result.resources[i];
    collections.created += c.created;
    collections.peak += c.peak;
    collections.memberships_peak += c.memberships_peak;
    collections.spilled += c.spilled;
    r.resources->push_back(resource(i, result.resources[i], c));
  }
  collections.fullness_mean = ratio(sum.packet_rays, sum.packets_issued * static_cast<std::uint64_t>(config.rays));
  r.tests = tests(sum.tests, rays);
  const auto kind = [&](std::uint64_t count) { return report::TestKind{count, ratio(count, rays)}; };
  if (accel.procedural_primitives) r.tests->procedural = kind(sum.tests.procedural);
  if (accel.calls_any_hit()) r.tests->any_hit = kind(sum.tests.any_hit_calls);
  r.tests->ray_reads = {sum.reads, ratio(sum.reads, rays)};
  if (!sum.bundles.empty()) r.tests->bundles = bundles(sum.bundles);
  if (!accel.planes.empty()) r.cull_planes = cull_planes(accel, sum.culls);
  r.packets = report::Packets{sum.packets_issued,
                              sum.packets_retired,
                              sum.hops,
                              ratio(sum.packet_rays, sum.packets_issued),
                              ratio(sum.local_rays, sum.seen_rays),
                              ratio(sum.bubbles, sum.visits)};
  r.collections = collections;
  const std::uint64_t done =
      sum.tests.box + sum.tests.plane + sum.tests.triangle + sum.tests.procedural + sum.tests.bundle;
  r.throughput = report::Throughput{ratio(sum.packets_issued, rays), ratio(sum.hops, rays), ratio(done, rays)};
}

void add_links(report::Report& r, const ringbus::RunResult& result, const Config& config) {
  r.links.emplace();
  for (const ringbus::LinkResult& link : result.links) {
    const ringbus::LinkStatistics& s = link.statistics;
    r.links->push_back({link.from.value, link.to.value, link.depth, s.packets, ratio(s.occupancy_sum, s.samples),
                        s.occupancy_max, s.refusals});
    report::Link& out = r.links->back();
    if (config.faults.links.any()) {
      const ringbus::LinkFaultCounts& f = link.faults;
      out.faults =
          report::LinkFaults{f.dropped, f.duplicated, f.corrupted, f.reordered, f.delayed, f.resent, f.discarded};
    }
    if (config.engine.kind == EngineKind::kCycle) continue;
    out.queue = enum_name(config.topology.link.queue);
    out.sent_at_once = ratio(s.packets, s.batches);
    out.received_at_once = ratio(s.packets, s.receives);
    out.full_stalls = s.full_stalls;
    out.empty_stalls = s.empty_stalls;
    out.occupancy.emplace();
    for (const ringbus::OccupancySeries::Entry& entry : link.series.entries())
      out.occupancy->push_back({std::chrono::duration<double>(entry.end - result.start).count(),
                                ratio(entry.sum, entry.samples), entry.most});
  }
}

report::Rate rate(std::uint64_t rays, std::uint64_t cycles, std::int64_t clock_mhz) {
  const double per_cycle = ratio(rays, cycles);
  return {1000 * per_cycle, per_cycle * static_cast<double>(clock_mhz)};
}

report::Units units(const ringbus::cycle::TileResult& tile, std::uint64_t cycles, const Config& config,
                    const accel::Accel& accel) {
  using ringbus::cycle::TileState;
  const auto in = [&](TileState state) { return tile.states[static_cast<std::size_t>(state)]; };
  const auto bank = [&](const ringbus::cycle::Utilisation& ledger) {
    return report::UnitCycles{ledger.busy,
                              in(TileState::kTesting)-ledger.busy,
                              in(TileState::kMemory),
                              in(TileState::kLink),
                              in(TileState::kCredits),
                              in(TileState::kStorage),
                              in(TileState::kShading),
                              in(TileState::kIdle)};
  };
  report::Units out{bank(tile.box), bank(tile.triangle), bank(tile.transform), tile.dispatch.busy,
                    cycles - tile.dispatch.busy};
  if (config.cull_planes.count > 0) out.plane = bank(tile.plane);
  if (config.bundles.size > 0) out.bundle = bank(tile.bundle);
  if (accel.procedural_primitives) out.procedural = bank(tile.procedural);
  if (accel.calls_any_hit() && config.testers.any_hit == TestersConfig::AnyHit::kInline)
    out.any_hit = bank(tile.any_hit);
  if (config.rays.reads_per_cycle > 0) out.ray_reads = bank(tile.ray_reads);
  return out;
}

report::Stack stack(const ringbus::cycle::StackTraffic& ledger) {
  return {ledger.pushed_bytes, ledger.popped_bytes, ledger.peak_bytes, ledger.ray_peak_bytes};
}

/// The parts that need a simulated clock.
void add_cycles(report::Report& r, const ringbus::cycle::CycleResult& c, const Config& config,
                const accel::Accel& accel) {
  r.engine.cycles = c.cycles;
  report::Epochs& epochs = r.engine.epochs.emplace();
  epochs.cycles_each = c.epochs.cycles_each;
  for (const std::uint64_t digest : c.epochs.digests) epochs.digests.push_back(fmt::format("{:016x}", digest));
  if (r.throughput) {
    r.throughput->whole = rate(r.rays.completed, c.cycles, config.engine.clock_mhz);
    if (c.steady_cycles > 0) r.throughput->steady = rate(c.steady_rays, c.steady_cycles, config.engine.clock_mhz);
  }
  for (std::size_t i = 0; r.resources && i < r.resources->size(); ++i) {
    (*r.resources)[i].units = units(c.tiles[i], c.cycles, config, accel);
    if (config.topology.shape == TopologyShape::kIndependent) (*r.resources)[i].stack = stack(c.tiles[i].stack);
    if (config.accuracy.transformed_ray == AccuracyConfig::TransformedRay::kStore) {
      const ringbus::TransformedRayBytes& bytes = c.tiles[i].transformed_rays;
      (*r.resources)[i].transformed_rays = {bytes.written, bytes.read, bytes.peak};
    }
  }
  for (std::size_t i = 0; r.links && i < r.links->size(); ++i) {
    const ringbus::cycle::Utilisation& use = c.links[i].use;
    const ringbus::cycle::Occupancy& queue = c.links[i].queue;
    (*r.links)[i].utilisation = ratio(use.busy, c.cycles);
    (*r.links)[i].occupancy_mean = ratio(queue.packet_cycles, c.cycles);
    (*r.links)[i].occupancy_max = queue.most;
    (*r.links)[i].stalled = use.stalled;
    (*r.links)[i].cycles = report::LinkCycles{use.busy, use.stalled, c.cycles - use.busy - use.stalled};
  }
  LatencyHistogram trips;
  for (const ringbus::cycle::TileResult& tile : c.tiles) trips.add(tile.round_trips);
  if (r.packets && trips.count() > 0)
    r.packets->latency =
        report::Latency{trips.mean(), trips.quantile(0.5), trips.quantile(0.95), trips.quantile(0.99), trips.max()};
  report::Memory& memory = r.memory.emplace();
  for (const ringbus::cycle::CacheResult& cache : c.caches)
    memory.caches.push_back(
        {cache.requests, cache.lines, cache.hits, cache.merged, cache.misses, ratio(cache.hits, cache.lines)});
  memory.dram_lines = c.memory_lines;
  memory.dram_bytes = c.memory_lines * static_cast<std::uint64_t>(config.memory.line_bytes);
  memory.dram_busy_cycles = c.memory_busy;
  memory.dram_utilisation = ratio(c.memory_busy, c.cycles);
  r.shading.utilisation = ratio(c.shading_busy, c.cycles * static_cast<std::uint64_t>(config.shading.workers));
}

report::Host host(const Prepared& p, const ringbus::RunResult& result) {
  report::Host out;
  out.threads = result.threads;
  out.wall_seconds = result.wall_seconds;
  out.rays_per_second = ratio(static_cast<double>(result.rays_completed), result.wall_seconds);
  out.scene_seconds = p.scene_seconds;
  out.build_seconds = p.build_seconds;
  if (p.config().cull_planes.count > 0) out.plane_seconds = p.plane_seconds;
  out.accel_bytes = p.accel.size_bytes();
  out.peak_memory_bytes = peak_memory_bytes();
  out.simd = accel::simd_targets().front();  // only the chosen one is left after a choice
  out.machine = machine_info();
  return out;
}

report::Verify verify(const accel::VerifyingWorkload& verifying) {
  report::Verify out{verifying.compared(), verifying.mismatches(), ""};
  if (const auto& example = verifying.example()) {
    const Hit &got = example->got.hit, &expected = example->expected.hit;
    out.example =
        fmt::format("path {} bounce {}: instance {} primitive {} t {}, expected instance {} primitive {} t {}",
                    example->got.tag.path, example->got.tag.bounce, got.instance, got.primitive, got.t,
                    expected.instance, expected.primitive, expected.t);
  }
  return out;
}

}  // namespace

report::Report build_report(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& result,
                            const accel::VerifyingWorkload* verifying) {
  const Config& config = prepared.config();
  report::Report r;
  r.incomplete = !result.complete;
  r.carousel = program_info();
  r.config = config_json(config);
  r.scene = summary(prepared);
  r.host = host(prepared, result);
  r.host.raster_seconds = job.raster_seconds();
  r.raster = job.raster();
  if (result.rays_restarted > 0 && !result.cycle) r.host.recovery_seconds = result.recovery_seconds;
  const bool alone = r.host.threads == 1;
  r.engine.kind = enum_name(config.engine.kind);
  r.engine.deterministic = alone || result.cycle.has_value();
  r.engine.reason = result.cycle ? "virtual time: nothing depends on the host's threads"
                    : alone
                        ? "one thread steps everything in a fixed order"
                        : "threads run on the wall clock: counts of packets and tests depend on their timing; rays, "
                          "hits and picture do not";
  const auto emitted = job.emitted();
  r.rays = {result.rays_emitted,   result.rays_completed,  result.rays_emitted - result.rays_completed,
            result.rays_restarted, result.paths_restarted, {emitted[0], emitted[1], emitted[2]}};
  if (!result.resources.empty()) {
    add_ring(r, result, config.packets, prepared.accel);
    add_links(r, result, config);
  }
  r.shading = {static_cast<std::uint64_t>(config.shading.workers),
               result.rays_completed,
               job.saturated(),
               std::nullopt,
               {},
               {},
               0,
               {},
               {}};
  add_effects(r.shading, prepared.scene, config);
  if (result.cycle) add_cycles(r, *result.cycle, config, prepared.accel);
  if (const FaultsConfig::Resource& fault = config.faults.resource;
      result.rays_restarted > 0 || (result.cycle && result.cycle->stop)) {
    report::Stop& stop = r.faults.emplace().stop.emplace();
    stop.resource = static_cast<std::uint64_t>(fault.number);
    stop.packets_discarded = result.packets_discarded;
    if (result.cycle && result.cycle->stop) {
      const ringbus::cycle::StopTimes& at = *result.cycle->stop;
      stop.stopped_cycle = at.stopped;
      stop.noticed_cycle = at.noticed;
      if (at.restarted > 0) stop.restarted_cycle = at.restarted;
    }
  }
  if (verifying) r.verify = verify(*verifying);
  r.digest = {job.hits_digest(), job.image_digest()};
  return r;
}

}  // namespace carousel::app
