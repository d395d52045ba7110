#pragma once

#include <cstdint>

#include "core/config/fields/bundles.h"
#include "core/config/fields/collections.h"
#include "core/config/fields/engine.h"
#include "core/config/fields/packets.h"

namespace carousel {
struct Config;
}

namespace carousel::ringbus {

/// The parts of the configuration that a resource follows.
struct ResourceSettings {
  CollectionsConfig collections;
  PacketsConfig packets;
  BundlesConfig bundles;
  std::int64_t treelet_triangles = 2048;  ///< treelet traversal: a subtree of so many or fewer is one test
  std::uint32_t resources = 1;            ///< resources of the machine, for `home: hash`
  float scene_size = 1;                   ///< scale of entry distances and of boxes
  bool treelets = false;                  ///< rays gather at treelets of the whole tree
  Lanes lanes = Lanes::kAuto;             ///< treelet traversal without a tracer of the engine's own
};

ResourceSettings resource_settings(const Config& config, float scene_size);

}  // namespace carousel::ringbus
