#pragma once

#include <string>

#include "core/config/load/load.h"

namespace carousel::app {

/// The conventional machine with the resources, units, ray slots, caches, memory and shader workers of another: each
/// resource traces its own rays depth first, in warps. The lanes of vector units, test cells and testers behind a
/// distributor become units. Keys of packets, collections, bundles and the network have their defaults.
struct Twin {
  Config config;        ///< where caches, memories or shading are drawn, in that drawing without packets, if it can be
  Config plain;         ///< with wires beside the network, so that it may have any number of resources
  std::string drawing;  ///< of a machine that is drawn: how the network of `config` follows from it, or why not
};

/// Throws a ConfigError, with the position of the key, where the machine has no such twin.
Twin conventional_twin(const LocatedConfig& located);

}  // namespace carousel::app
