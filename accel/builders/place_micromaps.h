#pragma once

#include "accel/structure/accel.h"

namespace carousel::accel {

/// Lets a structure that is all here ask `maps`, which it does not own, before any-hit calls.
void set_micromaps(Accel& accel, const scene::OpacityMicromaps& maps);

}  // namespace carousel::accel
