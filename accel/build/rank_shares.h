#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/build/placed_blas.h"
#include "accel/structure/partition.h"

namespace carousel::accel {

/// The rank of each mesh, so that the shares are about as large as one another: the largest mesh first, to the rank
/// with the least (Graham 1969, "Bounds on multiprocessing timing anomalies").
std::vector<std::uint32_t> share_meshes(std::span<const std::uint64_t> sizes, std::uint32_t ranks);

/// Tells the other ranks of the structures that this one has built, those whose `home` it is, and learns of theirs what
/// the top level needs. Every rank calls.
void exchange_summaries(const BuildRanks& ranks, std::span<const std::uint32_t> home, std::span<PlacedBlas> blases);

/// From the sums of nodes and blocks by rank.
Partition partition_of(std::uint32_t rank, std::span<const std::uint64_t> nodes, std::span<const std::uint64_t> blocks);

}  // namespace carousel::accel
