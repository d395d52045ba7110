#pragma once

#include "accel/certificate/property.h"

namespace carousel::accel {

// Each is judged by exact arithmetic on the case's own floats, never by formulas of the kernels.

/// No box that the exact ray meets is missed.
Property box_property();
/// A box is entered no later than every box inside it that is entered: hits do not depend on the tree
/// (docs/how-it-works/design.md, What a hit is).
Property nested_boxes_property();
/// One triangle: crossed or not, t, u and v.
Property triangle_property();
/// The distance of a triangle that is met is off by no more than the level's bound.
Property distance_property();
/// From inside a closed mesh, aimed at its edges and vertices, something is hit.
Property closed_mesh_property();
/// Closed meshes in instances lose no ray either, up to the condition at which the promise ends.
Property placed_mesh_property();
/// Points and directions brought to an instance's space are off by no more than the level's bound.
Property transform_property();
/// An instance's world box holds all points of the model's box.
Property world_box_property();

}  // namespace carousel::accel
