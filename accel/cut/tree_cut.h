#pragma once

#include <cstdint>
#include <span>

#include "accel/structure/accel.h"
#include "accel/structure/tree_pieces.h"
#include "core/config/fields/bvh.h"

namespace carousel::accel {

/// Cuts the tree into connected pieces of at most `bvh.treelets.bytes`; a node or leaf that is larger is a piece by
/// itself. The method is that of T. Aila and T. Karras, Architecture Considerations for Tracing Incoherent Rays, HPG
/// 2010, section 4: from the leaves up, the best piece below each node is grown by the node of the cut with the most
/// area for its bytes, and of the sizes that it passes the one is kept after which the areas of the roots of all pieces
/// below, each with a price for being one, add up to the least. Deterministic; time in proportion to nodes x nodes a
/// piece x children that leave it.
///
/// `as_floats`: nodes that keep their boxes as floats although others are quantised. Precondition: `accel` is whole,
/// not one rank's part, and its boxes and cull planes are final.
TreePieces cut_tree(const Accel& accel, const BvhConfig& bvh, std::span<const std::uint32_t> as_floats);

}  // namespace carousel::accel
