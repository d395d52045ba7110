#pragma once

#include <cstdint>

#include "accel/box/bundle.h"
#include "accel/structure/accel.h"

namespace carousel::accel {

/// The primitives of `leaf` that a ray of the bundle may hit, a bit each in the order of its blocks (US 11308683, col.
/// 29). The bundle is given in the leaf's space. A primitive is left out only if every ray misses the primitive's own
/// box, which a hit has to lie in at every level of accuracy (docs/how-it-works/design.md, What a hit is), with the
/// roundings of the rays' own box tests: the hits of the others are the hits of all. Any thread may call.
std::uint32_t primitives_in_reach(const Accel& accel, NodeRef leaf, const BundleRecord& bundle);

}  // namespace carousel::accel
