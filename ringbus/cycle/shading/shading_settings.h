#pragma once

#include <cstdint>

#include "core/config/config.h"

namespace carousel::ringbus::cycle {

/// The parts of the configuration that ray control and shading follow.
struct ShadingSettings {
  ShadingConfig shading;
  BundlesConfig bundles;
  LinkConfig link;
  FaultsConfig::Resource fault;
  std::size_t workers = 1;
  std::size_t slots = 0;        ///< slots of all resources
  std::size_t packet_rays = 1;  ///< new rays that make a group
  std::uint64_t seed = 1;
  bool addressed = false;  ///< rays travel to the resources that they name
};

inline ShadingSettings shading_settings(const Config& config) {
  return {config.shading,
          config.bundles,
          config.topology.link,
          config.faults.resource,
          static_cast<std::size_t>(shader_workers(config)),
          static_cast<std::size_t>(config.topology.resources * config.rays.slots_per_resource),
          static_cast<std::size_t>(config.packets.rays),
          static_cast<std::uint64_t>(config.image.seed),
          config.rays.placement == Placement::kAddressed};
}

}  // namespace carousel::ringbus::cycle
