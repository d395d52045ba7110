#pragma once

#include "accel/structure/accel.h"

namespace carousel::accel {

/// Replaces the boxes of each node's children by those that 8 bits a plane can hold: an origin and a power of two an
/// axis for the node, and planes at whole multiples of it, rounded outwards (H. Ylitie, T. Karras, S. Laine, Efficient
/// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017, section 3). A new box contains the old one,
/// so that no ray loses a hit. Lanes without a child stay as they are.
void quantise_boxes(Accel& accel);

}  // namespace carousel::accel
