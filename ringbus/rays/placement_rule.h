#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types/workload.h"

namespace carousel::ringbus {

/// The facts by which a rule places a ray.
struct PlacementFacts {
  std::span<const std::size_t> free_slots;  ///< by resource; one that has stopped has none
  std::uint64_t placed = 0;                 ///< rays that have been placed before, in all
};

/// A dispatch of new rays that a plugin brings (`rays.placement`). Rays are placed one by one; with `home: local`, with
/// independent resources and with bundles the first ray of a group, or of a bundle, speaks for all.
struct PlacementRule {
  /// The number of the resource for a ray, below free_slots.size(). Where that one is full, the next ones are tried in
  /// turn. One thread at a time; the same facts must give the same resource.
  std::uint32_t (*choose)(const RayRequest& ray, const PlacementFacts& facts) = nullptr;
};

}  // namespace carousel::ringbus
