#pragma once

#include "accel/box/bundle.h"
#include "core/config/fields/accuracy.h"
#include "core/config/fields/bundles.h"
#include "core/types/aabb.h"

namespace carousel::accel {

/// A bundle as the silhouette test wants it (US 11308683): the outline of a box, as seen from where the rays start, has
/// four edges (one face is seen) or six, and a ray passes each inside or outside, which a comparison of two products
/// says, without a division. For bundles of one octant only.
class BundleSilhouette {
 public:
  /// True if the test exists for this bundle: the directions lie in one octant, and neither they nor the range are so
  /// large or so small that the slab test's values would overflow or underflow.
  static bool applies(const BundleRecord& bundle);

  BundleSilhouette(const BundleRecord& bundle, BoxLevel level, BundlesConfig::Edges edges);

  /// True if the slab test of every ray misses. Adds the edges tested to `edges`.
  bool all_miss(const Aabb& box, unsigned& edges) const;
  /// True if every ray whose range ends where the bundle's does hits the box, exactly and in the slab test. Adds the
  /// edges tested to `edges`.
  bool all_hit(const Aabb& box, unsigned& edges) const;

 private:
  /// The rays along one axis; all that follows is along their direction.
  struct Axis {
    bool backwards;
    double hindmost, foremost;  ///< origins
    double slowest, fastest;    ///< sizes of directions
  };
  /// The distances from the rays' origins to the planes of a box, along each axis.
  struct Ways {
    double to_near_least[3], to_near_most[3], to_far_least[3], to_far_most[3];
    unsigned edges;  ///< number of edges in the silhouette of the box
  };
  Ways ways(const Aabb& box) const;

  Axis axes_[3];
  double tmax_;
  double rounding_, missed_by_, hit_by_;  // factors
  bool one_after_another_;
};

}  // namespace carousel::accel
