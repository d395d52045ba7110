#pragma once

#include <cstdint>

namespace carousel::ringbus {

/// Counts the fates of bundles. A lane is one child box that was tested against one bundle.
struct BundleCounts {
  std::uint64_t all = 0;  ///< lanes that the bundle goes on to whole: AllHit says yes, or AnyHit where it decides alone
  std::uint64_t none = 0;   ///< lanes that AnyHit rules out for all of its rays
  std::uint64_t split = 0;  ///< lanes that its rays were tested against one by one
  std::uint64_t lane_rays =
      0;  ///< rays of the bundles, summed over all lanes: the box tests that single rays would need
  std::uint64_t split_rays = 0;   ///< the same over the lanes that were split: the box tests that were done after all
  std::uint64_t visits = 0;       ///< bundles tested
  std::uint64_t visit_rays = 0;   ///< rays in them: the records that would be read without bundles
  std::uint64_t touched = 0;      ///< records of rays that were read nevertheless, when bundles split or dissolved
  std::uint64_t taken_apart = 0;  ///< bundles whose rays were tested one by one: leaves, subtrees, instances
  std::uint64_t formed = 0, formed_rays = 0;  ///< counted when they dissolve
  std::uint64_t loaded = 0,
                loaded_rays = 0;  ///< of these, those of new rays; the others were made of the rays of split ones

  /// A bundle of `rays` was tested against the boxes of a node: of its `lanes`, `whole` hit as one and `undecided`.
  void add_visit(std::uint64_t rays, std::uint64_t lanes, int whole, int undecided) {
    const auto hit = static_cast<std::uint64_t>(whole), left = static_cast<std::uint64_t>(undecided);
    all += hit;
    split += left;
    none += lanes - hit - left;
    lane_rays += lanes * rays;
    split_rays += left * rays;
    visits += 1;
    visit_rays += rays;
  }
  /// A bundle of `rays` dissolved; `of_new_rays` unless it was made of the rays of split ones.
  void add_dissolved(std::uint64_t rays, bool of_new_rays) {
    ++formed;
    formed_rays += rays;
    touched += rays;
    if (!of_new_rays) return;
    ++loaded;
    loaded_rays += rays;
  }

  BundleCounts& operator+=(const BundleCounts& o) {
    all += o.all;
    none += o.none;
    split += o.split;
    lane_rays += o.lane_rays;
    split_rays += o.split_rays;
    touched += o.touched;
    visits += o.visits;
    visit_rays += o.visit_rays;
    taken_apart += o.taken_apart;
    formed += o.formed;
    formed_rays += o.formed_rays;
    loaded += o.loaded;
    loaded_rays += o.loaded_rays;
    return *this;
  }
  friend bool operator==(const BundleCounts&, const BundleCounts&) = default;
};

}  // namespace carousel::ringbus
