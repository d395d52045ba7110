#pragma once

#include "accel/structure/accel.h"

namespace carousel::accel {

/// The bytes of `maps` with the primitives of a structure that is all here.
MicromapPlaces place_micromaps(const Accel& accel, const scene::OpacityMicromaps& maps);

}  // namespace carousel::accel
