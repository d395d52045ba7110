#include "bench/cycle/cycle_speed.h"

#include <stdexcept>

#include <fmt/format.h>

#include "bench/common/list_workload.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/traffic/traffic_engine.h"

namespace carousel::bench {

namespace {

double per_second(std::uint64_t count, double seconds) {
  return static_cast<double>(count) / seconds;
}

TrafficCase traffic_case(const std::string& name, std::int64_t packets, TopologyShape shape, std::int64_t resources,
                         double rate, Flow flow) {
  TrafficCase out{name, {}};
  Config& c = out.config;
  c.engine.kind = EngineKind::kCycle;
  c.topology.shape = shape;
  c.topology.resources = resources;
  c.topology.flow = flow;
  c.workload.kind = WorkloadConfig::Kind::kTraffic;
  c.workload.traffic.rate = rate;
  c.workload.traffic.packets = packets;
  return out;
}

RayCase ray_case(std::int64_t resources, Traversal traversal, std::size_t threads,
                 DramConfig::Preset preset = DramConfig::Preset::kPipe) {
  RayCase out;
  out.threads = threads;
  out.name = fmt::format("{} resources, {}", resources, traversal == Traversal::kTreelet ? "treelet" : "spread");
  Config& c = out.config;
  c.engine.kind = EngineKind::kCycle;
  c.topology.resources = resources;
  c.topology.visit = Visit::kOwners;
  c.collections.traversal = traversal;
  c.memory.dram.preset = preset;
  if (preset != DramConfig::Preset::kPipe) out.name += fmt::format(", {}", enum_name(preset));
  return out;
}

}  // namespace

std::vector<TrafficCase> traffic_cases(std::int64_t packets) {
  using Shape = TopologyShape;
  return {
      traffic_case("bidirectional ring, uniform 0.1, bubble", packets, Shape::kBidirectional, 16, 0.1, Flow::kBubble),
      traffic_case("bidirectional ring, uniform 0.1, credits", packets, Shape::kBidirectional, 16, 0.1, Flow::kCredits),
      traffic_case("ring, uniform 0.1, bubble", packets, Shape::kRing, 16, 0.1, Flow::kBubble),
      traffic_case("ring, uniform 0.02, bubble", packets, Shape::kRing, 64, 0.02, Flow::kBubble),
  };
}

TrafficSpeed measure_traffic(const TrafficCase& one, int repetitions) {
  TrafficSpeed out;
  out.name = one.name;
  out.resources = static_cast<std::uint64_t>(one.config.topology.resources);
  std::vector<double> speeds;
  for (int i = 0; i < repetitions; ++i) {
    const Stopwatch stopwatch;
    const ringbus::TrafficResult result = ringbus::run_traffic(one.config, {});
    speeds.push_back(per_second(result.flit_hops, stopwatch.elapsed().cpu));
    out.flit_hops = result.flit_hops;
    out.cycles = result.cycles;
  }
  out.flit_hops_per_cpu_second = spread_of(speeds);
  return out;
}

std::vector<RayCase> ray_cases() {
  return {ray_case(16, Traversal::kSpread, 1),
          ray_case(16, Traversal::kTreelet, 1),
          ray_case(64, Traversal::kSpread, 1),
          ray_case(64, Traversal::kTreelet, 1),
          ray_case(64, Traversal::kSpread, 2),
          ray_case(8, Traversal::kTreelet, 1),
          ray_case(256, Traversal::kTreelet, 1),
          ray_case(16, Traversal::kSpread, 1, DramConfig::Preset::kGddr6),
          ray_case(16, Traversal::kTreelet, 1, DramConfig::Preset::kGddr6)};
}

RaySet primary_and_bounce(const scene::Scene& scene, const accel::Accel& accel, std::uint32_t image_side) {
  RaySet out;
  out.name = "primary and bounce";
  for (const RaySet& set : make_ray_sets(scene, accel, image_side, 1)) {
    if (set.name != "primary" && set.name != "bounce") continue;
    for (std::size_t i = 0; i < set.size; ++i) out.push_back(set[i].ray);
  }
  return out;
}

RaySpeed measure_rays(const RayCase& one, const accel::Accel& accel, float scene_size, const RaySet& rays,
                      int repetitions) {
  RaySpeed out;
  out.name = one.name;
  out.resources = static_cast<std::uint64_t>(one.config.topology.resources);
  out.rays = rays.size;
  std::vector<double> ray_speeds, hop_speeds, wall_speeds;
  HitList hits(rays.size);
  ringbus::RunOptions options;
  options.threads = one.threads;
  for (int i = 0; i < repetitions; ++i) {
    ListWorkload workload(rays, hits);
    const Stopwatch stopwatch;
    const ringbus::RunResult result = ringbus::run_cycle(one.config, accel, scene_size, workload, options);
    const Elapsed elapsed = stopwatch.elapsed();
    out.threads = result.threads;
    out.cycles = result.cycle->cycles;
    out.hops = result.cycle->hops;
    ray_speeds.push_back(per_second(rays.size, elapsed.cpu));
    hop_speeds.push_back(per_second(out.hops, elapsed.cpu));
    wall_speeds.push_back(per_second(rays.size, elapsed.wall));
  }
  const HitList expected = reference_hits(accel, rays);
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].instance != expected[i].instance || hits[i].primitive != expected[i].primitive ||
        hits[i].t != expected[i].t)
      throw std::runtime_error(fmt::format("{}: ray {} differs from the depth-first tracer", one.name, i));
  out.rays_per_cpu_second = spread_of(ray_speeds);
  out.hops_per_cpu_second = spread_of(hop_speeds);
  out.rays_per_wall_second = spread_of(wall_speeds);
  return out;
}

}  // namespace carousel::bench
