#pragma once

#include <cstdint>

#include "accel/box/bundle.h"
#include "accel/structure/accel.h"
#include "core/config/fields/bundles.h"
#include "core/statistics/intersection_counts.h"

namespace carousel::accel {

/// The result of a bundle's tests of the children of a node, a bit a lane. Every ray misses a lane in neither set.
struct BundleAnswer {
  std::uint8_t all = 0;        ///< every ray hits the box, as far as is known: the bundle goes down whole
  std::uint8_t undecided = 0;  ///< some may hit and some may miss: the bundle is split for this lane
  std::uint8_t edges = 0;      ///< tested edges of silhouettes; 0 if the interval form was used
  bool silhouettes = false;    ///< the silhouette form was used
  /// Passes through a unit that does one test of a box, or of one edge with `edges: serial`, at a time: of the tests
  /// that are made in any case, and of those that the order makes only where the first ones have not decided. With
  /// `order: parallel` the second ones are those for any ray, made in any case too.
  std::uint8_t first_passes = 0, second_passes = 0;
  float entry[kMaxWidth] = {};  ///< a lower bound of the rays' entries, of lanes in `all`
};

/// Divisions that the interval form makes for a bundle: of both ends of its range of directions, by axis.
inline constexpr std::uint32_t kDirectionDivisions = 6;

/// Tests a bundle against those child boxes of inner node `node` that `lanes` selects, in the form and order of
/// `config`, and at the accel's level of accuracy for boxes. A lane is left out only if the box test of every ray that
/// the record bounds would miss it, rounding included. A lane in `all` is hit by each such test if the ray's range ends
/// where the bundle's does (the record does not know which rays have a closer hit), and, with `config.strict`, also by
/// each such ray in exact arithmetic; with `any_hit_only` it may be hit by some rays only. A bundle of one gets the
/// answer of the ray's own test, except that `strict` may leave a lane undecided that is hit by rounding.
/// The interval form replaces the silhouette form for single rays, directions of several octants, and extreme
/// exponents. Counts the bundle tests, their edges and divisions: six for the directions in interval form, or one for
/// the entry of each box in `all` in silhouette form, whose nearest plane products find. Any thread may call.
BundleAnswer test_bundle(const Accel& accel, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                         const BundlesConfig& config, IntersectionCounts& counts);

}  // namespace carousel::accel
