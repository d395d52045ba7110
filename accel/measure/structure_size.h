#pragma once

#include <cstdint>

#include "accel/structure/accel.h"

namespace carousel::accel {

/// The structures over meshes, each counted once; of a partitioned one the part that is here, so that those of all
/// ranks add up to the whole.
struct StructureSize {
  std::uint64_t primitives = 0, references = 0;
  std::uint64_t inner_nodes = 0, leaves = 0;
  /// Inner nodes and blocks that a line through a mesh's box meets on average: the sum of their areas over that of the
  /// mesh (MacDonald, Booth 1990, "Heuristics for ray tracing using space subdivision"); the mean over meshes, weighted
  /// by their primitives; of a partitioned one by their references.
  double surface_cost = 0;

  StructureSize& operator+=(const StructureSize& share) {
    primitives += share.primitives;
    references += share.references;
    inner_nodes += share.inner_nodes;
    leaves += share.leaves;
    surface_cost += share.surface_cost;
    return *this;
  }
};

StructureSize structure_size(const Accel& accel);

}  // namespace carousel::accel
