// A machine that has plenty of everything, for tests that make one part of it scarce.
#pragma once

#include <functional>
#include <string>

#include "ringbus/verdict/what_if.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {

inline Config generous_machine() {
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.resources = 4;
  c.topology.link = {QueueKind::kSpscRing, 32, 1, 1024};
  c.packets.ids_per_cycle = 1024;
  c.collections.when_full = WhenFull::kSpill;
  c.rays.slots_per_resource = 512;
  c.testers.units[UnitKind::kBox] = c.testers.units[UnitKind::kTriangle] =
      c.testers.units[UnitKind::kTransform] = {256, 1, 1};
  c.testers.contexts = 4;
  c.memory.l2_latency_cycles = c.memory.dram_latency_cycles = 2;
  c.memory.dram_bytes_per_cycle = 65536;
  c.memory.fetch_ahead = 8;
  c.memory.shape_buffer_kib = 1024;
  c.memory.l2_lines_per_cycle = 64;
  c.shading.workers = 64;
  c.shading.cycles_per_shade = 1;
  return c;
}

/// A scarcity.
struct Plant {
  std::string name;  ///< name of the class of parts that is scarce
  std::function<void(Config&)> make;
  double longer = 0;  ///< by how much the what_if may make the run longer, where the class does not limit the machine
};

inline RunResult run_whole(TestScene& scene, const Config& config) {
  ScatterWorkload workload = scene.workload();
  return run_cycle(config, scene.accel(config.bvh), scene.size(), workload, on_threads(1));
}

}  // namespace carousel::ringbus
