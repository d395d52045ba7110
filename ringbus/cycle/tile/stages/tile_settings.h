#pragma once

#include "core/config/config.h"
#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/resource/settings.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"

namespace carousel::ringbus::cycle {

/// The parts of the configuration that one resource of a simulated machine follows.
struct TileSettings {
  ResourceSettings resource;
  TestersConfig testers;  ///< the resource's own, at the levels of accuracy
  AccuracyConfig accuracy;
  CullPlanesConfig::Order plane_order = CullPlanesConfig::Order::kBoxFirst;
  std::int64_t reads_per_cycle = 0;
  std::int64_t cells = 0, banks = 0;  ///< that hold its slots in turn; 0: none
  bool central = false, has_distributor = false;
  MemoryConfig memory;
  LinkConfig link;
  FaultsConfig::Resource fault;
  bool statistics = true;
  Observation observed;
  Recording recording{};
  const ShapeBlocks* blocks = nullptr;  ///< by which collections are keyed; null: by nodes

  /// A packet does not bring its shapes: each resource fetches those that it needs.
  bool fetches_by_resource() const { return memory.fetch != MemoryConfig::Fetch::kPacket; }
};

inline TileSettings tile_settings(const Config& config, ResourceId id, float scene_size, bool statistics,
                                  const Observation& observed) {
  return {resource_settings(config, scene_size),
          testers_of(config, id),
          config.accuracy,
          config.cull_planes.order,
          config.rays.reads_per_cycle,
          has_cells(config) ? testers_of(config, id).simd.lanes : 0,
          config.rays.banks,
          config.topology.shape == TopologyShape::kCentral,
          has_distributor(config),
          config.memory,
          config.topology.link,
          config.faults.resource,
          statistics,
          observed,
          {},
          nullptr};
}

}  // namespace carousel::ringbus::cycle
