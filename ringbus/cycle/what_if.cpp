#include "ringbus/cycle/what_if.h"

#include <algorithm>

#include <fmt/format.h>

#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/results/run_features.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

namespace {

/// The first `paths` rays of a workload, with all rays that follow from them.
class FirstPaths final : public Workload {
 public:
  FirstPaths(std::unique_ptr<Workload> whole, std::uint64_t paths) : whole_(std::move(whole)), left_(paths) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    Generated made = whole_->generate(worker, std::min<std::uint64_t>(max_rays, left_), out);
    left_ -= made.rays;
    made.finished |= left_ == 0;
    return made;
  }
  std::uint32_t extra_effects(const RayResult& result) const override { return whole_->extra_effects(result); }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    whole_->shade(worker, completed, out);
  }

 private:
  std::unique_ptr<Workload> whole_;
  std::uint64_t left_;
};

std::int64_t halved(std::int64_t cycles) {
  return std::max<std::int64_t>(1, cycles / 2);
}

bool passes_packets(const Config& c) {
  return Topology(c.topology).has_packets();
}
bool uses_links(const Config& c) {
  return passes_packets(c) && c.topology.resources > 1 && c.collections.home != Home::kLocal;
}

/// A class of parts other than test units.
struct PartClass {
  const char *name, *action;
  bool (*present)(const Config&);
  void (*relax)(Config&);
};
constexpr bool every_machine(const Config&) {
  return true;
}
constexpr PartClass kPartClasses[] = {
    {"ray_reads", "twice rays.reads_per_cycle", [](const Config& c) { return c.rays.reads_per_cycle > 0; },
     [](Config& c) { c.rays.reads_per_cycle *= 2; }},
    {"handling", "twice packets.ids_per_cycle", passes_packets, [](Config& c) { c.packets.ids_per_cycle *= 2; }},
    {"memory_latency", "half memory.l2_latency_cycles and memory.dram_latency_cycles", every_machine,
     [](Config& c) {
       c.memory.l2_latency_cycles = halved(c.memory.l2_latency_cycles);
       c.memory.dram_latency_cycles = halved(c.memory.dram_latency_cycles);
     }},
    {"memory_bandwidth", "twice memory.dram_bytes_per_cycle", every_machine,
     [](Config& c) { c.memory.dram_bytes_per_cycle *= 2; }},
    {"ray_slots", "twice rays.slots_per_resource", every_machine, [](Config& c) { c.rays.slots_per_resource *= 2; }},
    {"shading", "twice shading.workers", every_machine, [](Config& c) { c.shading.workers = 2 * shader_workers(c); }},
    {"link_bandwidth", "twice topology.link.bytes_per_cycle", uses_links,
     [](Config& c) { c.topology.link.bytes_per_cycle *= 2; }},
    {"link_latency", "half topology.link.latency_cycles",
     [](const Config& c) { return uses_links(c) && c.topology.link.latency_cycles > 1; },
     [](Config& c) { c.topology.link.latency_cycles = halved(c.topology.link.latency_cycles); }},
    {"packets_in_flight", "twice topology.link.depth", uses_links, [](Config& c) { c.topology.link.depth *= 2; }},
};

}  // namespace

std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel) {
  std::vector<WhatIf> all;
  const RunFeatures features = features_of(config, accel);
  for (const UnitKindRow& row : kUnitKinds) {
    if (!features.show(row.shown)) continue;
    all.push_back({row.work, fmt::format("twice testers.{}.units", row.key), [kind = row.kind](Config& c) {
                     c.testers.units[kind].units *= 2;
                     for (ResourceOverride& one : c.topology.overrides) one.testers.units[kind].units *= 2;
                   }});
  }
  for (const PartClass& part : kPartClasses)
    if (part.present(config)) all.push_back({part.name, part.action, part.relax});
  return all;
}

std::uint64_t pilot_paths(const Config& config) {
  // So many that the first misses of the caches count for little: memory would otherwise seem slower than it is to
  // small machines, whose slots turn over sooner.
  constexpr std::int64_t kWarm = 6000;
  return static_cast<std::uint64_t>(std::max(kWarm, 8 * config.topology.resources * config.rays.slots_per_resource));
}

double steady_rate(const cycle::CycleResult& result, std::uint64_t rays) {
  const bool steady = result.steady_cycles > 0 && result.steady_rays >= 64;
  return 1000.0 * static_cast<double>(steady ? result.steady_rays : rays) /
         static_cast<double>(std::max<cycle::Cycle>(1, steady ? result.steady_cycles : result.cycles));
}

Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const WorkloadFactory& make_workload, std::uint64_t paths, const RunOptions& options) {
  const auto simulate = [&](const Config& machine) {
    FirstPaths workload(make_workload(machine), paths);
    return run_cycle(machine, accel, scene_size, workload, options);
  };
  Bottleneck out;
  out.paths = paths;
  // The bottleneck is that of the whole machine, before a resource stops.
  Config whole = config;
  if (whole.faults.resource.kind == FaultsConfig::Resource::Kind::kStop) whole.faults.resource = {};
  const RunResult base = simulate(whole);
  out.rays_per_kilocycle = steady_rate(*base.cycle, base.rays_completed);
  out.noise = base.cycle->steady_spread;
  for (const WhatIf& what_if : what_ifs(config, accel)) {
    if (options.stop.stop_requested()) break;
    Config relaxed = whole;
    what_if.apply(relaxed);
    const RunResult result = simulate(relaxed);
    Gain gain{what_if.name, what_if.action, steady_rate(*result.cycle, result.rays_completed), 0};
    gain.gain = gain.rays_per_kilocycle / out.rays_per_kilocycle - 1;
    out.gains.push_back(std::move(gain));
  }
  std::stable_sort(out.gains.begin(), out.gains.end(), [](const Gain& a, const Gain& b) { return a.gain > b.gain; });
  return out;
}

}  // namespace carousel::ringbus
