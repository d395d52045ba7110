#pragma once

#include <cstdint>

namespace carousel::ringbus {

/// What became of bundles. A lane is one child box that was tested against one bundle.
struct BundleCounts {
  std::uint64_t all = 0;   ///< lanes settled by AllHit (or where AnyHit alone lets bundles through): it goes down whole
  std::uint64_t none = 0;  ///< lanes settled by AnyHit: it does not go there
  std::uint64_t split = 0;        ///< lanes that were left to its rays
  std::uint64_t lane_rays = 0;    ///< rays of the bundles, summed over these lanes: as many box tests without bundles
  std::uint64_t split_rays = 0;   ///< the same over lanes that were split: box tests that were done after all
  std::uint64_t visits = 0;       ///< bundles tested
  std::uint64_t visit_rays = 0;   ///< rays in them: as many records to be read without bundles
  std::uint64_t touched = 0;      ///< records of rays that were read all the same, when bundles split or dissolved
  std::uint64_t taken_apart = 0;  ///< bundles whose rays were tested one by one: leaves, subtrees, instances
  std::uint64_t formed = 0, formed_rays = 0;  ///< counted when they dissolve
  std::uint64_t loaded = 0, loaded_rays = 0;  ///< of these, those of new rays: the others were made of split ones

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
