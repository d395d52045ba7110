#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <optional>

#include "core/config/key_conditions.h"
#include "core/config/load/load.h"

namespace carousel::app {

/// A split of an area between parts of a machine. Each part has a power of two of what the configuration gives it: the
/// test units of a resource, the shared caches, their ports, and the shader workers for a resource. Resources take what
/// is left.
struct AreaSplit {
  enum Part : std::size_t { kTesters, kCaches, kPorts, kShaders };
  static constexpr std::size_t kParts = 4;
  static constexpr int kMostSteps = 3;

  std::array<int, kParts> steps{};

  auto operator<=>(const AreaSplit&) const = default;
};

/// Returns the machine of a split with as many resources as area.budget_mm2 holds. Its area.fit is refuse, and it has
/// no aim. What all resources share grows with them. It returns none if no number of resources is within the budget, if
/// a part would be out of its range, or if a part is as large as a step nearer to the configuration.
std::optional<Config> machine_of(const LocatedConfig& given, const SceneFacts& scene, const AreaSplit& split);

}  // namespace carousel::app
