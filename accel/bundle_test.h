#pragma once

#include <cstdint>

#include "accel/accel.h"
#include "accel/bundle.h"
#include "core/config.h"
#include "core/test_counts.h"

namespace carousel::accel {

/// What a bundle's tests say of the children of a node, a bit a lane. A lane in neither is missed by every ray.
struct BundleAnswer {
  std::uint8_t all = 0;        ///< every ray hits the box, as far as is known: the bundle goes down whole
  std::uint8_t undecided = 0;  ///< some may hit and some may miss: the bundle is split for this lane
  float entry[kMaxWidth] = {};  ///< a lower bound of the rays' entries, of lanes in `all`
};

/// Tests a bundle against those child boxes of inner node `node` that `lanes` selects, in the form and order of
/// `config`, and at the accel's level of accuracy for boxes: a lane is left out only if the box test of every ray that
/// the record bounds would miss it, rounding included. With `config.strict` a lane in `all` is one that every such
/// test hits. Counts the bundle tests. Any thread may call.
BundleAnswer test_bundle(const Accel& accel, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                         const BundlesConfig& config, TestCounts& counts);

}  // namespace carousel::accel
