#include "bench/ring_runner.h"

#include <chrono>

#include "bench/list_workload.h"

namespace carousel::bench {

Config ring_config(const RingSettings& settings, const RingForm& form, int threads) {
  Config config;
  config.engine.threads = threads;
  config.shading.workers = threads;
  config.topology.resources = form.resources;
  config.topology.link.depth = settings.link_depth;
  config.topology.link.queue = settings.queue;
  config.rays.slots_per_resource = settings.slots;
  config.packets.rays = settings.packet_rays;
  config.collections.ready = settings.ready;
  config.collections.capacity = settings.capacity;
  config.collections.traversal = form.traversal;
  config.collections.home = form.home;
  config.collections.policy = settings.policy;
  config.collections.select = settings.select;
  config.bvh.treelet_triangles = settings.treelet_triangles;
  return config;
}

RingRun run_ring(const accel::Accel& accel, float scene_size, const RingSettings& settings,
                 const RingForm& form, const RaySet& rays, int threads, HitList& hits) {
  const Config config = ring_config(settings, form, threads);
  ringbus::RunOptions options;
  options.threads = static_cast<std::size_t>(threads);
  options.statistics = form.statistics;
  ListWorkload workload(rays, hits);
  const auto start = std::chrono::steady_clock::now();
  RingRun run;
  run.result = ringbus::run_native(config, accel, scene_size, workload, options);
  run.to_first_packet_seconds = std::chrono::duration<double>(workload.started() - start).count();
  return run;
}

}  // namespace carousel::bench
