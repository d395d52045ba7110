// Shader workers make, and are charged for, the camera rays that there are.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::camera_ray_cost_test {
namespace {

class CameraRayCost : public TimedRun {
 protected:
  Json picture(int side, int packet_rays, std::vector<std::string> sets = {}) {
    sets.push_back(fmt::format("packets.rays={}", packet_rays));
    return report(
        fmt::format("scene: {{builtin: terrain, triangles: 600}}\n"
                    "image: {{width: {}, height: {}, samples: 1, max_depth: 2}}\n"
                    "shading: {{workers: 1, cycles_per_shade: 20, cycles_per_lookup: 0, products_per_cycle: 0}}\n",
                    side, side),
        sets);
  }
  static double busy(const Json& report) {
    return report["shading"]["utilisation"].get<double>() * report["engine"]["cycles"].get<double>();
  }
  static double paid(const Json& report) {
    return 20 * (report["rays"]["completed"].get<double>() + report["rays"]["by_kind"]["camera"].get<double>());
  }
};

TEST_F(CameraRayCost, OnePixelCostsOneRayWhateverThePackets) {
  // The camera ray's hit sends a shadow ray at most, so that never two rays share a packet.
  const std::vector<std::string> direct{"image.max_depth=1"};
  const Json single = picture(1, 1, direct), few = picture(1, 4, direct), many = picture(1, 32, direct);
  for (const Json& run : {single, few, many}) {
    EXPECT_EQ(run["rays"]["by_kind"]["camera"], 1);
    EXPECT_NEAR(busy(run), paid(run), 1e-6);
    EXPECT_EQ(run["engine"]["cycles"], single["engine"]["cycles"]);
  }
}

TEST_F(CameraRayCost, IsPaidForEachRay) {
  for (const int side : {3, 9})
    for (const int packet_rays : {1, 5, 32})
      for (const char* shade : {"shading.workers=1", "shading.cycles_per_shade=0", "primary=raster"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", side, packet_rays, shade));
        const Json run = picture(side, packet_rays, {shade});
        if (shade == std::string("shading.workers=1")) {
          EXPECT_NEAR(busy(run), paid(run), 1e-6);
        }
        EXPECT_EQ(run["rays"]["completed"], run["rays"]["emitted"]);
      }
}

}  // namespace
}  // namespace carousel::camera_ray_cost_test
