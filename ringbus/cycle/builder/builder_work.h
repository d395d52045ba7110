#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/builders/clusters.h"
#include "accel/builders/refit.h"
#include "accel/structure/accel.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::ringbus::cycle {

/// A piece of the builder's work: when all is there that it reads, its boxes are put together, and then it writes.
struct BuilderTask {
  std::vector<ShapeSpan> reads{}, writes{};
  std::uint64_t boxes = 0;
  bool top = false;  ///< of the top level, not of a mesh
};

/// Tasks by level: those of one level need all of the levels before it, and nothing of one another.
struct BuilderWork {
  std::vector<std::vector<BuilderTask>> levels{};
  std::vector<ShapeSpan> moved{};  ///< what others have written since the last frame, of all that is read

  std::vector<BuilderTask>& level(std::size_t number) {
    if (levels.size() <= number) levels.resize(number + 1);
    return levels[number];
  }
};

/// All parts of a structure, for one that is built anew as a whole.
accel::ChangedParts all_parts(const accel::Accel& accel);

/// A refit, from the leaves up. A leaf reads itself, for the numbers of its primitives, and their positions, 36 bytes
/// each in a list behind the structure. A node reads itself, for its references, and its children, whose boxes it adds
/// up. In the top level it reads the matrix of each instance, 48 bytes, and the root of its mesh. What is read is
/// written back. Unused keys of `memory` have their defaults.
BuilderWork refit_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts);

/// A build of the structure as it is, from the top down, by sorting primitives into bins (I. Wald, On fast construction
/// of SAH-based bounding volume hierarchies, 2007), whose outcome is the structure that `bvh` asks for. A primitive's
/// record of 32 bytes (box and number) is written once. Each halving of a node reads the records below it twice, for
/// the bins and to part them, and writes them once; a node of n children takes log2 n halvings, rounded up. A subtree
/// of at most `local_primitives` reads its records once, and the positions and opacity micromaps of its primitives, and
/// is written as a whole.
BuilderWork rebuild_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts,
                         std::uint64_t local_primitives);

/// An update of clusters that has been done (`done`, accel::update_clusters). A bit a cluster says which have moved.
/// Each of these reads the list of its primitives' numbers, 4 bytes each, its nodes, for their references, and the
/// positions of its primitives, and writes its nodes and leaves, a record of 32 bytes with its box and root, and the
/// list if it is another. A task takes neighbours that moved, up to `local_primitives`. Where clusters are dealt out,
/// the records of those that have not moved are read, and for each node above a list of its children, 4 bytes each. A
/// list that is new is written, and a node with another cluster below it or one that moved. Other nodes above clusters
/// that moved read themselves and the records or nodes of children that have moved, and are written. The top level is
/// refitted.
BuilderWork cluster_work(const accel::Accel& accel, const ShapeMemory& memory, const accel::ChangedParts& parts,
                         const accel::TreeClusters& clusters, std::span<const accel::ClusterWork> done,
                         std::uint64_t local_primitives);

/// Bytes that the builder keeps of clusters beside the structure: their bits, records and lists, and those of children.
std::uint64_t cluster_bytes(const accel::Accel& accel, const accel::TreeClusters& clusters);

}  // namespace carousel::ringbus::cycle
