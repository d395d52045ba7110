// rays.sort: cells. The order is the one that the key's cells and octants have by another calculation, no ray is lost
// or changed, and the native engine's rays go out in it.
#include "ringbus/rays/ray_sorter.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "core/config/load/load.h"
#include "core/system/executor.h"
#include "ringbus/native/native_engine.h"

namespace carousel::ringbus {
namespace {

RayBatch random_rays(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-1, 1);
  RayBatch rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Ray& ray = rays[i].ray;
    ray.origin = {7 + 3 * place(random), place(random), 0.01f * place(random)};
    ray.direction = {place(random), place(random), place(random)};
    if (i % 7 == 0) ray.direction[static_cast<int>(i / 7 % 3)] = i % 2 == 0 ? 0.0f : -0.0f;
    if (i % 50 == 3) ray.origin[static_cast<int>(i % 3)] = i % 4 == 0 ? kInfinity : -kInfinity;
    if (i % 50 == 4) ray.origin[static_cast<int>(i % 3)] = std::nanf("");
    rays[i].tag.path = static_cast<std::uint32_t>(i);
  }
  return rays;
}

/// A ray's place by definition: bit by bit along the curve through the cells of the finite origins' box.
std::uint32_t place_of(const Ray& ray, const RayBatch& all) {
  double lo[3] = {1e99, 1e99, 1e99}, longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double hi = -1e99;
    for (const RayRequest& one : all) {
      const Vec3& o = one.ray.origin;
      if (!std::isfinite(o.x + o.y + o.z)) continue;
      lo[axis] = std::min(lo[axis], double{o[axis]});
      hi = std::max(hi, double{o[axis]});
    }
    longest = std::max(longest, hi - lo[axis]);
  }
  std::uint32_t place = 0;
  for (int bit = RaySorter::kCellBits - 1; bit >= 0; --bit)
    for (int axis = 2; axis >= 0; --axis) {
      const double at = (double{ray.origin[axis]} - lo[axis]) * 128 / longest;
      const int cell = at > 0 ? static_cast<int>(std::min(at, 127.0)) : 0;
      place = place << 1 | static_cast<std::uint32_t>(cell >> bit & 1);
    }
  for (int axis = 2; axis >= 0; --axis) place = place << 1 | (std::signbit(ray.direction[axis]) ? 1u : 0u);
  return place;
}

// Few rays are sorted in another way than many; the sorter is used again and again.
TEST(RaySorter, PutsRaysInTheOrderOfTheirCellsAndOctants) {
  std::mt19937 random(5);
  RaySorter sorter;
  for (const std::size_t count : {300u, 0u, 1u, 2u, 1023u, 1024u, 2000u, 17u}) {
    const RayBatch before = random_rays(count, random);
    RayBatch after;
    sorter.order(before);
    sorter.copy(before, 0, count / 3, after);
    sorter.copy(before, count / 3, count, after);
    ASSERT_EQ(after.size(), count);
    std::vector<int> seen(count);
    std::uint32_t last = 0, last_path = 0;
    for (const RayRequest& request : after) {
      const std::uint32_t path = request.tag.path;
      ASSERT_LT(path, count);
      EXPECT_EQ(++seen[path], 1);
      EXPECT_EQ(std::memcmp(&request.ray, &before[path].ray, sizeof(Ray)), 0);
      const std::uint32_t place = place_of(request.ray, before);
      EXPECT_GE(place, last);
      if (place == last && last != 0) {
        EXPECT_GT(path, last_path) << "rays of a place keep their order";
      }
      last = place;
      last_path = path;
    }
  }
}

TEST(RaySorter, CopesWithOriginsInOnePlaceOrNone) {
  RayBatch rays(3);
  for (RayRequest& request : rays) request.ray.origin = {2, 2, 2};
  rays[1].ray.direction = {0, 0, -1};
  rays[2].tag.path = 2;
  RaySorter sorter;
  RayBatch sorted;
  sorter.order(rays);
  sorter.copy(rays, 0, 3, sorted);
  EXPECT_EQ(sorted[1].tag.path, 2u);
  EXPECT_TRUE(std::signbit(sorted[2].ray.direction.z));
  for (RayRequest& request : rays) request.ray.origin = {kInfinity, std::nanf(""), -kInfinity};
  sorter.order(rays);
  sorter.copy(rays, 0, 3, sorted);
  EXPECT_EQ(sorted.size(), 6u);
}

/// Makes rays, and a further one of each, and notes in which order they come back.
class NotingWorkload final : public Workload {
 public:
  explicit NotingWorkload(const RayBatch& rays) : rays_(rays) {}
  Generated generate(WorkerId, std::size_t most, RayBatch& out) override {
    const std::size_t count = std::min(most, rays_.size() - next_);
    const auto first = rays_.begin() + static_cast<std::ptrdiff_t>(next_);
    out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(count));
    next_ += count;
    return {count, next_ == rays_.size()};
  }
  void shade(WorkerId, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& result : completed) {
      if (result.tag.bounce == 1) {
        ++further;
        continue;
      }
      back.push_back(result.tag.path);
      RayRequest& next = out.emplace_back(rays_[result.tag.path]);
      next.tag.bounce = 1;
    }
  }
  std::vector<std::uint32_t> back;
  std::size_t further = 0;

 private:
  const RayBatch& rays_;
  std::size_t next_ = 0;
};

// In an empty scene rays come back in the order in which they went out.
TEST(RaySorter, SortsTheRaysOfTheNativeEngine) {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene.cameras.emplace_back();
  std::mt19937 random(7);
  const RayBatch rays = random_rays(1500, random);
  for (const std::string sort : {"none", "cells"}) {
    const std::string text =
        "scene: {builtin: cornell}\nengine: {kind: native}\ntopology: {resources: 1}\nrays: {slots_per_resource: 8192, "
        "sort: " +
        sort + "}\npackets: {rays: 16}\n";
    const Config config = load_config({text, "machine.yaml"}).config;
    NotingWorkload workload(rays);
    const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
    const RunResult result = run_native(config, accel, 1, workload, {});
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(workload.further, rays.size());
    ASSERT_EQ(workload.back.size(), rays.size());
    std::size_t later = 0;
    for (std::size_t i = 1; i < rays.size(); ++i)
      later += place_of(rays[workload.back[i]].ray, rays) < place_of(rays[workload.back[i - 1]].ray, rays);
    EXPECT_EQ(later == 0, sort == "cells") << later;
  }
}

}  // namespace
}  // namespace carousel::ringbus
