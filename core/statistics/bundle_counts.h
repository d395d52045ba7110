#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The outcome of testing bundles of rays. A lane is one child box tested against one bundle.
struct BundleCounts {
  std::uint64_t all = 0, none = 0, split = 0;
  std::uint64_t lane_rays = 0, split_rays = 0;
  std::uint64_t visits = 0, visit_rays = 0, touched = 0, taken_apart = 0;
  std::uint64_t formed = 0, formed_rays = 0, loaded = 0, loaded_rays = 0;
  std::uint64_t regrouped = 0, returned = 0;
  std::uint64_t leaf_tests = 0, leaf_misses = 0, leaf_tests_spared = 0;

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
        Counter{"regrouped", &C::regrouped, "rays",
                "rays that left a bundle and passed the builder again, with lifetime: reformed or another split than "
                "tester"},
        Counter{"returned", &C::returned, "bundles",
                "bundles that went back to the builder untested, with split: untested"},
        Counter{"leaf_tests", &C::leaf_tests, "tests", "tests of a bundle against a primitive, with leaf: primitives"},
        Counter{"leaf_misses", &C::leaf_misses, "tests", "those of them that showed that every ray misses"},
        Counter{"leaf_tests_spared", &C::leaf_tests_spared, "tests",
                "tests of a ray against a primitive that these misses made unnecessary"},
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
