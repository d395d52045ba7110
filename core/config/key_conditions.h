#pragma once

#include <optional>
#include <string_view>

#include "core/config/config.h"

namespace carousel {

// One table says which parts of a machine its scene and the rest of its configuration put to use, by the keys of these
// parts. Ignored keys are named by it (core/config/ignored_keys.h), the search for the bottleneck relaxes only parts
// that are in use (ringbus/verdict/what_if.h), and only these have an area (app/area/machine_area.h).

/// The things in a scene that put test units to use. By default a scene may hold anything.
struct SceneFacts {
  bool transforms = true;  ///< some instance has a transform
  bool any_hit = true;     ///< some hits are decided by any-hit calls
  bool procedural = true;  ///< there are procedural primitives
  bool planes = true;      ///< nodes have cull planes
  bool gaussians = true;   ///< it consists of Gaussians
  bool harmonics = true;   ///< their colours depend on directions
};

/// The reason for which the machine cannot feel `key`, a path without list indices: a clause such as "one resource has
/// no links". Absent if it can.
std::optional<std::string_view> unused_because(const Config& config, const SceneFacts& scene, std::string_view key);

/// True if the key's part of the machine is in use.
inline bool in_use(const Config& config, const SceneFacts& scene, std::string_view key) {
  return !unused_because(config, scene, key);
}

/// The units of this kind are in use.
bool has_units(const Config& config, const SceneFacts& scene, UnitKind kind);

}  // namespace carousel
