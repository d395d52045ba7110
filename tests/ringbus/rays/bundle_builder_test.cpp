#include "ringbus/rays/bundle_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/traverse/ray_check.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {
namespace {

using accel::Random;
using accel::ray_to;
using Builder = BundlesConfig::Builder;
using Groups = std::vector<std::vector<std::uint32_t>>;

constexpr float kSceneSize = 10;

BundlesConfig of_size(std::int64_t size, double threshold = 0.1) {
  BundlesConfig config;
  config.size = size;
  config.builder.threshold = threshold;
  return config;
}

Groups groups_of(BundleBuilder& builder, const RayBatch& rays) {
  std::vector<std::uint32_t> order{77};
  std::vector<std::uint8_t> sizes{77};  // overwritten
  builder.group(rays, order, sizes);
  Groups groups;
  std::size_t at = 0;
  for (const std::uint8_t size : sizes) {
    EXPECT_GT(size, 0);
    EXPECT_LE(at + size, order.size());
    groups.emplace_back(order.data() + at, order.data() + at + size);
    at += size;
  }
  EXPECT_EQ(at, order.size());
  return groups;
}
Groups groups_of(const BundlesConfig& config, const RayBatch& rays) {
  BundleBuilder builder(config, kSceneSize);
  return groups_of(builder, rays);
}

/// A ray close to (0, 0, 1), or to another direction when that is given.
RayRequest ray_along(float x, float y = 0, float z = 1) {
  return ray_to(Vec3{0}, {x, y, z});
}

/// Rays through the pixels of a square image, a row after the other.
RayBatch camera_rays(int pixels) {
  RayBatch rays;
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x)
      rays.push_back(ray_along((float(x) + 0.5f) / float(pixels) - 0.5f, (float(y) + 0.5f) / float(pixels) - 0.5f));
  return rays;
}

/// Some rays that resemble each other, some that do not, and some that no bundle takes.
RayBatch mixed_batch(Random& random, std::size_t count) {
  RayBatch rays;
  Vec3 origin{0}, direction{0, 0, 1};
  while (rays.size() < count) {
    if (random.below(8) == 0) {
      origin = random.in_box(Vec3{-5}, Vec3{5});
      direction = random.in_box(Vec3{-1}, Vec3{1});
    }
    RayRequest r = ray_to(origin, direction + random.in_box(Vec3{-0.05f}, Vec3{0.05f}));
    if (random.below(2)) r.ray.origin += random.in_box(Vec3{-0.1f}, Vec3{0.1f});
    if (random.below(10) == 0) r.ray.direction[static_cast<int>(random.below(3))] = random.below(2) ? 0.0f : -0.0f;
    if (random.below(30) == 0) r.ray.tmin = 0.5f;
    if (random.below(30) == 0) r.ray.direction = Vec3{random.any_bits(), random.any_bits(), 0};
    if (random.below(60) == 0) r.ray.direction = Vec3{0};
    r.tag.kind = static_cast<RayKind>(random.below(3));
    rays.push_back(r);
  }
  return rays;
}

BundlesConfig any_config(Random& random) {
  BundlesConfig config = of_size(std::int64_t{1} << random.below(7));
  config.min_rays = 2 + random.below(4);
  config.sources = static_cast<BundlesConfig::Sources>(random.below(3));
  config.builder.open = 1 + random.below(20), config.builder.age = 1 + random.below(100);
  config.builder.similarity = static_cast<Builder::Similarity>(random.below(4));
  config.builder.measure = static_cast<Builder::Measure>(random.below(2));
  config.builder.threshold = random.uniform(0, 0.5f);
  config.builder.same_origin = random.below(3) == 0, config.builder.same_signs = random.below(2) == 0;
  return config;
}

double largest(const DVec3& v) {
  return std::max({v.x, v.y, v.z});
}
bool same_signs(const Vec3& a, const Vec3& b) {
  return std::signbit(a.x) == std::signbit(b.x) && std::signbit(a.y) == std::signbit(b.y) &&
         std::signbit(a.z) == std::signbit(b.z);
}

TEST(BundleBuilder, PutsEveryRayInExactlyOneGroupThatObeysTheConfiguration) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  Random random(1000 * std::uint64_t{run_seed()} + 81);
  std::size_t bundled = 0, alone = 0;
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const BundlesConfig config = any_config(random);
    BundleBuilder builder(config, kSceneSize);
    for (int call = 0; call < 2; ++call) {  // a call leaves nothing behind
      const RayBatch rays = mixed_batch(random, random.below(300));
      std::vector<int> seen(rays.size());
      for (const auto& group : groups_of(builder, rays)) {
        for (const std::uint32_t i : group) ++seen.at(i);
        (group.size() == 1 ? alone : bundled) += group.size();
        if (group.size() == 1) continue;
        ASSERT_LE(group.size(), static_cast<std::size_t>(config.size));
        ASSERT_GE(group.size(), static_cast<std::size_t>(config.min_rays));
        ASSERT_TRUE(std::is_sorted(group.begin(), group.end()));
        const RayRequest& first = rays[group[0]];
        for (const std::uint32_t i : group) {
          const RayRequest& r = rays[i];
          ASSERT_TRUE(accel::valid(r.ray));
          ASSERT_EQ(r.ray.tmin, 0);
          ASSERT_EQ(r.tag.kind, first.tag.kind);
          if (config.sources == BundlesConfig::Sources::kCamera) {
            ASSERT_EQ(r.tag.kind, RayKind::kCamera);
          }
          if (config.sources == BundlesConfig::Sources::kShader) {
            ASSERT_NE(r.tag.kind, RayKind::kCamera);
          }
          if (config.builder.same_origin) {
            ASSERT_EQ(r.ray.origin, first.ray.origin);
          }
          if (config.builder.same_signs) {
            ASSERT_TRUE(same_signs(r.ray.direction, first.ray.direction));
          }
        }
      }
      for (const int times : seen) ASSERT_EQ(times, 1);
    }
  }
  EXPECT_GT(bundled, 10000u);
  EXPECT_GT(alone, 10000u);
}

TEST(BundleBuilder, GroupsTheSameRaysTheSameWay) {
  Random random(1000 * std::uint64_t{run_seed()} + 82);
  for (int round = 0; round < 20; ++round) {
    const BundlesConfig config = any_config(random);
    const RayBatch rays = mixed_batch(random, 300);
    BundleBuilder used(config, kSceneSize);
    groups_of(used, mixed_batch(random, 100));
    EXPECT_EQ(groups_of(used, rays), groups_of(config, rays));
  }
}

// Unit directions, so that it is plain what the thresholds measure.
TEST(BundleBuilder, KeepsBundlesBelowTheThreshold) {
  Random random(1000 * std::uint64_t{run_seed()} + 83);
  RayBatch rays;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 d = glm::normalize(Vec3{0, 0, 1} + random.in_box(Vec3{-0.15f}, Vec3{0.15f}));
    rays.push_back(ray_to(random.in_box(Vec3{-0.5f}, Vec3{0.5f}), d));
  }
  for (const auto similarity : {Builder::Similarity::kGrowth, Builder::Similarity::kComponentRange,
                                Builder::Similarity::kOriginBox, Builder::Similarity::kSolidAngle}) {
    for (const double threshold : {0.04, 0.09}) {
      BundlesConfig config = of_size(16, threshold);
      config.builder.similarity = similarity;
      config.builder.same_signs = false;
      std::size_t bundled = 0;
      bool far_apart = false, spread_out = false;
      for (const auto& group : groups_of(config, rays)) {
        if (group.size() > 1) bundled += group.size();
        DVec3 o_min(1e9), o_max(-1e9), d_min(1e9), d_max(-1e9);
        for (const std::uint32_t i : group) {
          const DVec3 o(rays[i].ray.origin), d(rays[i].ray.direction);
          o_min = glm::min(o_min, o), o_max = glm::max(o_max, o), d_min = glm::min(d_min, d),
          d_max = glm::max(d_max, d);
        }
        const double origins = largest(o_max - o_min) / kSceneSize, range = largest(d_max - d_min);
        const DVec3 e = d_max - d_min, c = glm::abs(0.5 * (d_min + d_max));
        const double angle = c.x * e.y * e.z + c.y * e.z * e.x + c.z * e.x * e.y;
        const double size = similarity == Builder::Similarity::kGrowth           ? std::max(origins, range)
                            : similarity == Builder::Similarity::kComponentRange ? range
                            : similarity == Builder::Similarity::kOriginBox      ? origins
                                                                                 : angle;
        EXPECT_LE(size, threshold + 1e-6) << enum_name(similarity);
        far_apart |= origins > threshold;
        spread_out |= range > threshold;
      }
      EXPECT_GT(bundled, 100u) << enum_name(similarity);
      // The similarity leaves the other ranges free.
      if (similarity == Builder::Similarity::kComponentRange) {
        EXPECT_TRUE(far_apart);
      }
      if (similarity == Builder::Similarity::kOriginBox) {
        EXPECT_TRUE(spread_out);
      }
    }
  }
}

TEST(BundleBuilder, PercentIsOfWhatTheBundleWasBefore) {
  BundlesConfig config = of_size(8, 0.5);
  config.builder.measure = Builder::Measure::kPercent;
  // Ranges 0.1, 0.1, 0.15 are growth by no more than a half; 0.25 is more.
  RayBatch rays{ray_along(0.1f), ray_along(0.2f), ray_along(0.15f), ray_along(0.249f), ray_along(0.35f)};
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 1, 2, 3}, {4}}));
  // A bundle without a size may grow to the threshold.
  rays = {ray_along(0.1f), ray_along(0.1f), ray_along(0.55f), ray_along(1.2f)};
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 1, 2}, {3}}));
}

TEST(BundleBuilder, FillsBundlesFromCameraRays) {
  for (const std::int64_t size : {4, 8, 16, 32, 64}) {
    const RayBatch rays = camera_rays(256);
    const Groups groups = groups_of(of_size(size, 64.0 / 256), rays);
    std::size_t in_full = 0;
    for (const auto& group : groups) in_full += group.size() == static_cast<std::size_t>(size) ? group.size() : 0;
    EXPECT_GT(in_full, rays.size() * 9 / 10) << size;
  }
}

TEST(BundleBuilder, ARayJoinsTheBundleThatItFitsBest) {
  BundlesConfig config = of_size(4, 0.3);
  config.builder.open = 2;
  // Two bundles, 0.4 apart, then a ray between them, closer to the second.
  EXPECT_EQ(groups_of(config, {ray_along(0.1f), ray_along(0.5f), ray_along(0.35f)}), (Groups{{0}, {1, 2}}));
  EXPECT_EQ(groups_of(config, {ray_along(0.1f), ray_along(0.5f), ray_along(0.25f)}), (Groups{{0, 2}, {1}}));
}

TEST(BundleBuilder, MakesRoomByTheFullest) {
  BundlesConfig config = of_size(8, 0.1);
  config.builder.open = 2;
  RayBatch rays;
  for (const float x : {0.1f, 1.0f, 1.0f, 2.0f, 0.1f, 2.0f, 3.0f}) rays.push_back(ray_along(x));
  // {1, 2} goes for ray 3; ray 4 still finds {0}; of two equally full ones the oldest goes for ray 6.
  EXPECT_EQ(groups_of(config, rays), (Groups{{1, 2}, {0, 4}, {3, 5}, {6}}));
}

TEST(BundleBuilder, SendsBundlesOnWhenTheyAreOld) {
  BundlesConfig config = of_size(8, 0.1);
  config.builder.age = 3;
  const RayBatch rays{ray_along(0.1f), ray_along(1), ray_along(0.1f), ray_along(0.1f), ray_along(1), ray_along(1)};
  // {0, 2} is three rays old when ray 3 comes, and {1} when ray 4 does.
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 2}, {1}, {3}, {4, 5}}));
  config.builder.age = 100;
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 2, 3}, {1, 4, 5}}));
}

TEST(BundleBuilder, AShadowRaySharesWithShadowRaysOnly) {
  RayBatch rays(6, ray_along(0));
  rays[1].tag.kind = rays[3].tag.kind = RayKind::kShadow;
  rays[4].tag.kind = rays[5].tag.kind = RayKind::kBounce;
  EXPECT_EQ(groups_of(of_size(4), rays), (Groups{{0, 2}, {1, 3}, {4, 5}}));
}

TEST(BundleBuilder, OnlyRaysOfTheConfiguredSourcesShare) {
  RayBatch rays(4, ray_along(0));
  rays[2].tag.kind = rays[3].tag.kind = RayKind::kBounce;
  BundlesConfig config = of_size(4);
  config.sources = BundlesConfig::Sources::kCamera;
  EXPECT_EQ(groups_of(config, rays), (Groups{{2}, {3}, {0, 1}}));
  config.sources = BundlesConfig::Sources::kShader;
  EXPECT_EQ(groups_of(config, rays), (Groups{{0}, {1}, {2, 3}}));
}

TEST(BundleBuilder, SignsAreThoseOfZerosToo) {
  const RayBatch rays{ray_along(0.0f), ray_along(-0.0f), ray_along(0.001f), ray_along(-0.001f)};
  BundlesConfig config = of_size(4);
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 2}, {1, 3}}));
  config.builder.same_signs = false;
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 1, 2, 3}}));
}

TEST(BundleBuilder, SameOriginIsToTheBit) {
  RayBatch rays(3, ray_along(0));
  rays[1].ray.origin.x = std::numeric_limits<float>::denorm_min();
  BundlesConfig config = of_size(4);
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 1, 2}}));
  config.builder.same_origin = true;
  EXPECT_EQ(groups_of(config, rays), (Groups{{0, 2}, {1}}));
}

TEST(BundleBuilder, RaysThatNoBundleTakesTravelOnTheirOwn) {
  RayBatch rays(6, ray_along(0));
  rays[1].ray.tmin = 1e-20f;
  rays[2].ray.direction = Vec3{0}, rays[3].ray.origin.y = kInfinity, rays[4].ray.tmax = -1;
  EXPECT_EQ(groups_of(of_size(4), rays), (Groups{{1}, {2}, {3}, {4}, {0, 5}}));
}

TEST(BundleBuilder, TooFewRaysTravelOnTheirOwn) {
  BundlesConfig config = of_size(4);
  config.min_rays = 3;
  EXPECT_EQ(groups_of(config, {ray_along(0), ray_along(1), ray_along(0), ray_along(1), ray_along(1)}),
            (Groups{{0}, {2}, {1, 3, 4}}));
}

TEST(BundleBuilder, WithoutBundlesEveryRayTravelsOnItsOwn) {
  EXPECT_EQ(groups_of(of_size(0), RayBatch(3, ray_along(0))), (Groups{{0}, {1}, {2}}));
  EXPECT_EQ(groups_of(of_size(8), {}), Groups{});
}

}  // namespace
}  // namespace carousel::ringbus
