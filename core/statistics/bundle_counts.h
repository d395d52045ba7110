#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The outcome of testing bundles of rays. A lane is one child box tested against one bundle.
struct BundleCounts {
  std::uint64_t all = 0, none = 0, split = 0;
  std::uint64_t lane_rays = 0, split_rays = 0;
  std::uint64_t visits = 0, visit_rays = 0, touched = 0, taken_apart = 0;
  std::uint64_t formed = 0, formed_rays = 0, loaded = 0, loaded_rays = 0;
  std::uint64_t edges = 0, regrouped = 0;

  static constexpr auto counters() {
    using C = BundleCounts;
    return std::array{
        Counter{"all_hit", &C::all, "boxes", "boxes to which every ray of a bundle went on"},
        Counter{"all_miss", &C::none, "boxes", "boxes to which no ray of a bundle went on"},
        Counter{"split", &C::split, "boxes", "boxes left to the single rays of a bundle"},
        Counter{"lane_rays", &C::lane_rays, "tests", "rays of bundles, once for each lane: box tests without bundles",
                Shown::kNever},
        Counter{"split_rays", &C::split_rays, "tests", "the same over split lanes: box tests done after all",
                Shown::kNever},
        Counter{"visits", &C::visits, "bundles", "bundles tested", Shown::kNever},
        Counter{"visit_rays", &C::visit_rays, "records", "rays in these bundles: records read without bundles",
                Shown::kNever},
        Counter{"touched", &C::touched, "records", "records of rays read because bundles split or dissolved",
                Shown::kNever},
        Counter{"taken_apart", &C::taken_apart, "bundles",
                "bundles whose rays were tested one by one, in leaves, subtrees and instances", Shown::kNever},
        Counter{"formed", &C::formed, "bundles", "bundles formed, counted when they dissolve", Shown::kNever},
        Counter{"formed_rays", &C::formed_rays, "rays", "rays of the bundles formed", Shown::kNever},
        Counter{"loaded", &C::loaded, "bundles", "bundles formed of new rays; the others were formed of split ones",
                Shown::kNever},
        Counter{"loaded_rays", &C::loaded_rays, "rays", "rays of the bundles formed of new rays", Shown::kNever},
        Counter{"edges", &C::edges, "edges", "edges of silhouettes that bundles were tested against"},
        Counter{"regrouped", &C::regrouped, "rays",
                "rays that left a bundle and passed the builder again, with lifetime: reformed or split: builder"},
    };
  }
  /// Tests of a ray against a box that bundles made unnecessary.
  constexpr std::uint64_t box_tests_spared() const { return lane_rays - split_rays; }
  /// Records of rays that need not be read; below zero if splitting and dissolving read more than bundles spare.
  constexpr std::int64_t ray_reads_spared() const {
    return static_cast<std::int64_t>(visit_rays) - static_cast<std::int64_t>(visits + touched + taken_apart);
  }
  friend bool operator==(const BundleCounts&, const BundleCounts&) = default;
};

}  // namespace carousel
