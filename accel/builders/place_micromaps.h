#pragma once

#include "accel/structure/accel.h"

namespace carousel::accel {

/// The bytes of `maps` with the primitives of a structure that is all here.
MicromapPlaces place_micromaps(const Accel& accel, const scene::OpacityMicromaps& maps);

/// Lets a structure that is all here ask `maps`, which it does not own, before any-hit calls.
inline void set_micromaps(Accel& accel, const scene::OpacityMicromaps& maps) {
  accel.micromaps = &maps;
  accel.micromap_places = place_micromaps(accel, maps);
}

}  // namespace carousel::accel
