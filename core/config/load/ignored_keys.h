#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/key_conditions.h"
#include "core/config/load/load.h"

namespace carousel {

/// A key that the user sets and the machine cannot feel.
struct IgnoredKey {
  std::string key;
  std::string_view why;  ///< a clause
  SourcePosition position;
};

/// The ignored keys of a configuration, in alphabetical order. A key is set where it is given, whatever its value; in a
/// file that gives every key, as config.resolved.yaml does, where its value is not the default.
std::vector<IgnoredKey> ignored_keys(const LocatedConfig& located, const SceneFacts& scene);

/// "topology.rings (the topology is no multi_ring), memory.ways, memory.l2_kib (...)": in one line.
std::string ignored_text(std::span<const IgnoredKey> keys);

/// Throws a ConfigError that names each of the keys, if there are any.
void refuse_ignored(std::span<const IgnoredKey> keys);

}  // namespace carousel
