#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/config.h"

namespace carousel {

/// A value that the configuration names and an engine does not have. Such a value is refused. Numbers of the simulated
/// machine (times, widths, sizes) mean nothing to the native engine, whose clock is the wall; it ignores them, so that
/// one file serves both engines.
struct NotBuilt {
  std::string key;
  std::string value;  ///< as in a file; empty: every value but the default
  enum class Without { kNative, kCycle, kBoth } without;
  std::string thing{};  ///< the words for the value in messages; empty: the value itself
};

/// All of them, as the rows of the keys say (`.only` in core/config/fields). Validation, schema, documentation and the
/// test of keys derive from it.
std::span<const NotBuilt> not_built();

namespace config {

/// The engines that take `value` at `key`, which is a path without list indices.
std::vector<EngineKind> engines_with(std::string_view key, std::string_view value);

struct Refusal {
  std::string key, message;
};

/// The values of a configuration that its engine does not have.
std::vector<Refusal> refusals(const Config& config);

}  // namespace config
}  // namespace carousel
