#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The fate of the completed rays of one bounce, and the rays that they caused.
struct BounceCounts {
  std::uint64_t rays = 0, begun = 0, escaped = 0, hit = 0, went_on = 0;
  std::uint64_t shadow = 0, shadow_begun = 0, lit = 0, occluded = 0, passed = 0;

  static constexpr auto counters() {
    using C = BounceCounts;
    return std::array{
        Counter{"rays", &C::rays, "rays", "completed rays that seek the closest hit: camera rays at bounce 0"},
        Counter{"begun", &C::begun, "rays",
                "such rays that no other ray caused: of the camera, of a file, or from a first hit of the raster pass"},
        Counter{"escaped", &C::escaped, "rays", "such rays that hit nothing"},
        Counter{"hit", &C::hit, "rays", "such rays that hit a surface"},
        Counter{"went_on", &C::went_on, "rays", "hits from which a ray of the next bounce set out"},
        Counter{"absorbed", &C::absorbed, "rays", "hits at which the path ended: absorbed, cut, or at the last bounce"},
        Counter{"shadow", &C::shadow, "rays", "completed shadow rays from surfaces of this bounce"},
        Counter{"shadow_begun", &C::shadow_begun, "rays", "such rays that no other ray caused"},
        Counter{"lit", &C::lit, "rays", "shadow rays that met nothing on their way to a light"},
        Counter{"occluded", &C::occluded_in_all, "rays", "shadow rays that met a surface and ended there"},
        Counter{"passed", &C::passed, "rays", "shadow rays that met a pane and went on behind it as another ray"},
        Counter{"shadow_hit", &C::occluded, "rays", "shadow rays that met a surface", Shown::kNever},
    };
  }
  constexpr std::uint64_t absorbed() const { return hit - went_on; }
  constexpr std::uint64_t occluded_in_all() const { return occluded - passed; }
  friend bool operator==(const BounceCounts&, const BounceCounts&) = default;
};

}  // namespace carousel
