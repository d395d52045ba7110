#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/types/aabb.h"
#include "core/types/workload.h"

namespace carousel::ringbus {

/// Puts rays that start in one cell and run into one octant next to one another, and cells along a Morton curve, so
/// that neighbours in the order meet much the same nodes.
class RaySorter {
 public:
  static constexpr int kCellBits = 7;  ///< of a cell's number along each axis

  /// Finds the order of `rays`.
  void order(const RayBatch& rays);
  /// Appends the rays from the `begin`-th to before the `end`-th in the order that was found for `rays` to `out`.
  void copy(const RayBatch& rays, std::size_t begin, std::size_t end, RayBatch& out) const;

 private:
  std::vector<std::uint64_t> keys_, other_;  // a ray's place in the order, and below it its number
};

}  // namespace carousel::ringbus
