#include "ringbus/cycle/tile/stages/tile_settings.h"

#include <utility>

#include "core/config/own_sections.h"
#include "ringbus/cycle/testers/level_cycles.h"
#include "ringbus/faults/resource_fault.h"

namespace carousel::ringbus::cycle {

namespace {

/// Testers, slowed by a fault, at the levels of accuracy.
TestersConfig testers_in_use(const Config& config, TestersConfig testers, ResourceId id) {
  slow_down(testers, config.faults, id);
  return at_levels(testers, config.accuracy, config.bundles);
}

}  // namespace

TileSettings tile_settings(const Config& config, ResourceId id, float scene_size, bool statistics,
                           const Observation& observed) {
  const OwnSections own = own_sections(config, id.value);
  const TestersConfig testers = testers_in_use(config, own.testers, id);
  ResourceSettings resource = resource_settings(config, scene_size);
  resource.collections = own.collections;
  resource.packets = own.packets;
  return {std::move(resource),
          testers,
          config.accuracy,
          config.cull_planes.order,
          own.rays.reads_per_cycle,
          has_cells(config) ? testers.simd.lanes : 0,
          config.rays.banks,
          is_central(config.topology),
          has_distributor(config),
          own.memory,
          config.topology.link,
          config.faults.resource,
          statistics,
          observed,
          {},
          nullptr};
}

}  // namespace carousel::ringbus::cycle
