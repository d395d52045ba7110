#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/builders/placed_blas.h"
#include "accel/structure/partition.h"
#include "core/system/executor.h"

namespace carousel::accel {

/// The rank of each mesh, so that the shares are about as large as one another: the largest mesh first, to the rank
/// with the least (Graham 1969, "Bounds on multiprocessing timing anomalies").
std::vector<std::uint32_t> share_meshes(std::span<const std::uint64_t> sizes, std::uint32_t ranks);

/// Makes the pieces of the meshes that get a structure each, in order of the meshes, and the rank of each piece. No
/// piece is larger than an eighth of a rank's share of all primitives, so the shares become about equal.
void share_out(std::span<const BlasMeshes> meshes, const BuildRanks& ranks, std::vector<PlacedBlas>& pieces,
               std::vector<std::uint32_t>& home);

/// Appends nodes above the pieces of a mesh, of which there are several, and returns the whole.
PlacedMesh join_at_top(std::span<const PlacedBlas> pieces, int width, Executor& executor, NodeArray& nodes);

/// Tells the other ranks of the structures that this one has built, those whose `home` it is, and learns of theirs what
/// the top level needs. Every rank calls.
void exchange_summaries(const BuildRanks& ranks, std::span<const std::uint32_t> home, std::span<PlacedBlas> blases);

/// From the sums of nodes and blocks by rank.
Partition partition_of(std::uint32_t rank, std::span<const std::uint64_t> nodes, std::span<const std::uint64_t> blocks);

}  // namespace carousel::accel
