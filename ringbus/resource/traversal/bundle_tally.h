#pragma once

#include <cstdint>

#include "core/statistics/bundle_counts.h"

namespace carousel::ringbus {

/// Counts a bundle of `rays` that was tested against the boxes of a node: of its `lanes`, it goes on to `whole` as one
/// and `undecided` are left to its rays.
inline void add_visit(BundleCounts& counts, std::uint64_t rays, std::uint64_t lanes, int whole, int undecided) {
  const auto hit = static_cast<std::uint64_t>(whole), left = static_cast<std::uint64_t>(undecided);
  counts.all += hit;
  counts.split += left;
  counts.none += lanes - hit - left;
  counts.lane_rays += lanes * rays;
  counts.split_rays += left * rays;
  counts.visits += 1;
  counts.visit_rays += rays;
}

/// Counts a bundle of `rays` that dissolves. `loaded`: it was made of new rays, not of the rays of split bundles.
inline void add_dissolved(BundleCounts& counts, std::uint64_t rays, bool loaded) {
  ++counts.formed;
  counts.formed_rays += rays;
  counts.touched += rays;
  if (!loaded) return;
  ++counts.loaded;
  counts.loaded_rays += rays;
}

}  // namespace carousel::ringbus
