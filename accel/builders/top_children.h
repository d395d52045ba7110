#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "core/types/aabb.h"

namespace carousel::accel {

/// A child of the top level: an instance, or a node or leaf of the meshes of the world that are merged.
struct TopChild {
  NodeRef ref;
  Aabb box;  ///< in the world
  std::uint8_t strip_size = 0;
  std::uint32_t triangles = 0;
};

/// Appends the subtrees of the merged meshes that hang in the top level, beside the instances that `out` holds. Where
/// there are some, the nodes with the largest boxes are opened, up to twice as many subtrees as there are instances, so
/// that the top level can be divided between them (C. Benthin, S. Woop, I. Wald, A. T. Afra, "Improved two-level BVHs
/// using partial re-braiding", HPG 2017, which opens all instances). Opened nodes stay in `nodes`, where nothing leads
/// to them.
void hang_opened(const InstanceNode& merged, const NodeArray& nodes, std::vector<TopChild>& out);

}  // namespace carousel::accel
