#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"

namespace carousel::accel {

/// Replaces the boxes of each node's children by those that `bits` a plane can hold: an origin and a power of two an
/// axis for the node, and planes at whole multiples of it, rounded outwards (H. Ylitie, T. Karras, S. Laine, Efficient
/// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017, section 3, with 8). A new box contains the
/// old one, so that no ray loses a hit. Lanes without a child stay as they are, and so do the unquantised_nodes().
void quantise_boxes(Accel& accel, int bits);

/// The nodes of the top level that keep their boxes as floats: those with a child that is an instance with a transform.
/// A hit has to lie in the world box of its instance (docs/how-it-works/design.md, What a hit is), which only the test
/// at such a node sees to; a larger box would let in rays that graze it. A triangle's own box is made from its
/// vertices, an instance without a transform adds nothing to the boxes below it, and a group's members are tested when
/// a ray leaves the group.
std::vector<std::uint32_t> unquantised_nodes(const Accel& accel);

}  // namespace carousel::accel
