// Shader workers with several lanes, with and without sorting by shader.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::shade_vectors_test {
namespace {

class ShadeVectors : public TimedRun {};

// Eight rays of one pixel, all of which miss: they are made in one job, are tested together, and come back together.
const char* const kEightMisses =
    "scene: {builtin: cornell}\nimage: {width: 1, height: 1, samples: 8, max_depth: 1}\n"
    "camera: {eye: [0, 0, 100], target: [0, 0, 200]}\ntopology: {resources: 1}\n"
    "shading: {workers: 1, cycles_per_shade: 40, effects: []}\n";

TEST_F(ShadeVectors, TakeAsLongAsHandsCompute) {
  const auto cycles = [this](std::vector<std::string> sets) {
    return report(kEightMisses, sets)["engine"]["cycles"].get<std::uint64_t>();
  };
  // 320 cycles to make the rays, and 320 to shade them.
  const std::uint64_t one = cycles({});
  EXPECT_EQ(cycles({"shading.lanes=8"}), one - 640 + 40 + 40);
  EXPECT_EQ(cycles({"shading.lanes=4"}), one - 640 + 80 + 80);
  EXPECT_EQ(cycles({"shading.lanes=3"}), one - 640 + 120 + 120);
  // The sorter has four rays a cycle after they have come, and the others another cycle later, for a second vector.
  EXPECT_EQ(cycles({"shading.lanes=8", "shading.sort=shader"}), one - 640 + 40 + 1 + 80);
  EXPECT_EQ(cycles({"shading.lanes=8", "shading.sort=shader", "shading.sort_rays_per_cycle=8"}),
            one - 640 + 40 + 1 + 40);
}

// The pictures are of the same rays in the same machine; only the order of shading differs.
TEST_F(ShadeVectors, SortedHaveOneShaderAndTheSamePicture) {
  for (const char* scene : {"cornell", "spheres"}) {
    for (const int width : {24, 40}) {
      const std::string machine = fmt::format(
          "scene: {{builtin: {}}}\nimage: {{width: {}, height: 16, samples: 1}}\n"
          "topology: {{resources: 4}}\nrays: {{slots_per_resource: 64}}\n"
          "shading: {{workers: 1, cycles_per_shade: 60}}\n",
          scene, width);
      const Json one = report(machine), mixed = report(machine, {"shading.lanes=8"}),
                 sorted = report(machine, {"shading.lanes=8", "shading.sort=shader", "shading.sort_rays_per_cycle=8"});
      const auto cycles = [](const Json& r) { return r["engine"]["cycles"].get<double>(); };
      for (const Json* r : {&mixed, &sorted}) {
        EXPECT_EQ((*r)["digest"], one["digest"]);
        const Json& vectors = (*r)["shading"]["vectors"];
        EXPECT_EQ(vectors["rays"], (*r)["shading"]["shaded"]);
        const double passes = vectors["vectors"].get<double>() * vectors["shaders"].get<double>();
        EXPECT_DOUBLE_EQ(vectors["fill"].get<double>(), vectors["rays"].get<double>() / (8 * passes));
        EXPECT_LT(cycles(*r), cycles(one)) << scene << width;
      }
      EXPECT_FALSE(one["shading"].contains("vectors"));
      EXPECT_EQ(sorted["shading"]["vectors"]["shaders"], 1);
      EXPECT_GT(mixed["shading"]["vectors"]["shaders"].get<double>(), 1.2) << scene << width;
      // Sorted vectors have fewer rays, but each of their passes has more.
      EXPECT_GT(sorted["shading"]["vectors"]["fill"], mixed["shading"]["vectors"]["fill"]) << scene << width;
      // One worker is what limits this machine, and its time is what different shaders of a vector cost.
      EXPECT_LT(cycles(sorted), cycles(mixed)) << scene << width;
    }
  }
}

// A machine that completes four rays a cycle, all of which miss. A sorter of one ray a cycle is slower than a ray a
// cycle, whatever stands around it.
TEST_F(ShadeVectors, TheSorterBoundsThem) {
  const auto cycles_a_ray = [this](int rate) {
    const Json r = report(
        "scene: {builtin: cornell}\nimage: {width: 32, height: 32, samples: 4, max_depth: 1}\n"
        "camera: {eye: [0, 0, 100], target: [0, 0, 200]}\n"
        "topology: {resources: 16, shape: independent}\ntesters: {box: {units: 64}}\n"
        "shading: {workers: 64, cycles_per_shade: 1, lanes: 64, sort: shader, effects: []}\n",
        {fmt::format("shading.sort_rays_per_cycle={}", rate)});
    return r["engine"]["cycles"].get<double>() / r["shading"]["shaded"].get<double>();
  };
  EXPECT_GT(cycles_a_ray(1), 1);
  EXPECT_GT(cycles_a_ray(2), 0.5);
  EXPECT_LT(cycles_a_ray(64), 0.5) << "so that the sorter is what the lines above see";
}

}  // namespace
}  // namespace carousel::shade_vectors_test
