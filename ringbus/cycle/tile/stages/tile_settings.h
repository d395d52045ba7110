#pragma once

#include <cstdint>

#include "core/config/fields/accuracy.h"
#include "core/config/fields/cull_planes.h"
#include "core/config/fields/faults.h"
#include "core/config/fields/memory.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/topology.h"
#include "core/types/ids.h"
#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/resource/settings.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"

namespace carousel {
struct Config;
}

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

  Cycle way_to_memory = 0;  ///< cycles over drawn links to memory and back, besides the latencies of `memory`

  /// A packet does not bring its shapes: each resource fetches those that it needs.
  bool fetches_by_resource() const { return memory.fetch != MemoryConfig::Fetch::kPacket; }
};

TileSettings tile_settings(const Config& config, ResourceId id, float scene_size, bool statistics,
                           const Observation& observed);

}  // namespace carousel::ringbus::cycle
