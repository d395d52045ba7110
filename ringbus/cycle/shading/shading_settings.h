#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/config/fields/bundles.h"
#include "core/config/fields/faults.h"
#include "core/config/fields/shading.h"
#include "core/config/fields/topology.h"
#include "core/program/shade_programs.h"

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
  std::shared_ptr<const ShadePrograms> programs{};  ///< null: shading takes constant times
  std::size_t vectors = 1;                          ///< that a worker holds at once
  bool addressed = false;                           ///< rays travel to the resources that they name
};

}  // namespace carousel::ringbus::cycle
