#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/config/key_conditions.h"
#include "core/config/load/load.h"

namespace carousel::app {

/// Something that costs a simulated machine nothing unless a key charges it.
struct Charge {
  const char* name;     ///< as in the report
  const char* meaning;  ///< what happens for nothing; a clause
  const char* key;      ///< that charges it; empty: none does
  const char* free;     ///< its value that charges nothing
  const char* charged;  ///< a usual one that does
  /// Without a key: the machines that have it are those with one of these settings, such as "a.b=c d=e"; a key
  /// without a value: those in which it has an effect.
  const char* where = "";
  bool (*has)(const Config&) = nullptr;  ///< in place of `where`: tells whether a machine has it
};

/// The one list of them.
std::span<const Charge> all_charges();

/// The charges that a simulated run of such a machine and scene would meet and does not pay.
std::vector<const Charge*> uncharged(const LocatedConfig& located, const SceneFacts& scene);

/// Reads a configuration with everything charged that has a key, as far as the machine may have it; what the user sets
/// stays. The values are those of all_charges(). Throws a ConfigError as load_config() does.
LocatedConfig load_charged(const ConfigText& text, const std::vector<std::string>& sets,
                           const ValidateOptions& options);

}  // namespace carousel::app
