#include "ringbus/cycle/tile/stages/tile_settings.h"

#include "core/config/config.h"
#include "ringbus/cycle/testers/level_cycles.h"
#include "ringbus/faults/resource_fault.h"

namespace carousel::ringbus::cycle {

namespace {

/// The testers of a resource, slowed by a fault, at the levels of accuracy.
TestersConfig testers_in_use(const Config& config, ResourceId id) {
  TestersConfig testers = testers_of(config.testers, config.topology, id.value);
  slow_down(testers, config.faults, id);
  return at_levels(testers, config.accuracy);
}

}  // namespace

TileSettings tile_settings(const Config& config, ResourceId id, float scene_size, bool statistics,
                           const Observation& observed) {
  const TestersConfig testers = testers_in_use(config, id);
  MemoryConfig memory = config.memory;
  memory.shape_buffer_kib = shape_buffer_kib_of(memory.shape_buffer_kib, config.topology, id.value);
  return {resource_settings(config, scene_size),
          testers,
          config.accuracy,
          config.cull_planes.order,
          config.rays.reads_per_cycle,
          has_cells(config) ? testers.simd.lanes : 0,
          config.rays.banks,
          is_central(config.topology),
          has_distributor(config),
          memory,
          config.topology.link,
          config.faults.resource,
          statistics,
          observed,
          {},
          nullptr};
}

}  // namespace carousel::ringbus::cycle
