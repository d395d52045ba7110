#pragma once

#include "core/config/load/load.h"

namespace carousel::app {

/// The conventional machine with the resources, units, ray slots, caches, memory and shader workers of `config`: each
/// resource traces its own rays depth first, in warps. The lanes of vector units, test cells and testers behind a
/// distributor become units. Keys of packets, collections, bundles and the network have their defaults. Throws a
/// ConfigError, with the position of the key, where the machine has no such twin.
Config conventional_twin(const LocatedConfig& located);

}  // namespace carousel::app
