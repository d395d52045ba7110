// The watertight test decides in float and answers in double: nothing that the float hits is lost, and the distance is
// the exact one to a rounding.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/box/slab.h"
#include "accel/certificate/case_random.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/placement_cases.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/triangle_cases.h"
#include "accel/traverse/exact_reference.h"
#include "accel/traverse/ray_check.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

/// The largest error of the distance on a floor 2000 units wide, tilted so, of rays that graze it, in ulp.
double worst_on_floor(double degrees, TriangleLevel level) {
  const DMat3 turn = rotation({1, 2, 3}, degrees);
  const auto at = [&](double x, double z) { return Vec3(turn * DVec3(x, 0, z)); };
  scene::Mesh floor;
  floor.positions = {at(-1000, -1000), at(1000, -1000), at(1000, 1000), at(-1000, 1000)};
  floor.indices = {0, 1, 2, 0, 2, 3};
  const scene::Scene scene = scene_of(floor);
  AccuracyConfig accuracy;
  accuracy.triangle = level;
  const Accel accel = build_sequential(scene, 8, 4, accuracy);
  const ExactReference reference(scene);
  Random random(run_seed() + 900);
  double worst = 0;
  for (int i = 0; i < scaled(5000, 1000); ++i) {
    const Vec3 from(turn * DVec3(random.uniform(-5, 5), 1, random.uniform(-5, 5)));
    const double away = std::pow(10.0, random.uniform(0.5f, 2.5f)), angle = random.uniform(0, 6.28f);
    const RayRequest ray = ray_to(from, glm::normalize(at(away * std::cos(angle), away * std::sin(angle)) - from));
    const ExactHit exact = reference.closest(ray.ray);
    const Hit hit = trace_one(accel, ray);
    if (!exact.hit.valid() || hit.primitive != exact.hit.primitive) continue;
    worst = std::max(worst, std::fabs(hit.t - exact.t) / (std::nextafter(exact.hit.t, kInfinity) - exact.hit.t));
  }
  return worst;
}

TEST(PreciseDistance, AFloorThatIsGrazedIsMetToAnUlp) {
  EXPECT_LE(worst_on_floor(33, TriangleLevel::kWatertight), 0.51);
  // The entry into the floor's own box, as flat as the floor, is rounded three times.
  EXPECT_LE(worst_on_floor(0, TriangleLevel::kWatertight), 3);
  EXPECT_GT(worst_on_floor(33, TriangleLevel::kFast), 2);  // or the rays were not hard
}

TEST(PreciseDistance, StaysWithinItsBoundInHardCases) {
  const Property property = distance_property();
  const std::vector<AccuracyConfig> levels = levels_of(property);
  std::size_t judged = 0, fast_is_off = 0;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scaled(30'000, 5'000)); ++i) {
    CaseRandom random(run_seed(), property.number, i);
    std::vector<Judgement> out(levels.size());
    property.judge(property.make(random), levels, out, nullptr);
    for (std::size_t l = 0; l < levels.size(); ++l) {
      if (!out[l].applies) continue;
      if (levels[l].triangle == TriangleLevel::kFast) {
        fast_is_off += out[l].broken;
        continue;
      }
      ++judged;
      EXPECT_FALSE(out[l].broken) << "case " << i << ", " << level_name(property, levels[l]) << ", off by "
                                  << out[l].error << " ulp, CAROUSEL_SEED=" << run_seed();
    }
  }
  EXPECT_GT(judged, 1000u);
  EXPECT_GT(fast_is_off, 100u);
}

/// The test in float alone (Woop, Benthin, Wald 2013, appendix A).
bool float_hits(const Ray& ray, const Corners& p) {
  const Vec3 d = ray.direction;
  int kz = 0;
  if (std::fabs(d.y) >= std::fabs(d[kz])) kz = 1;
  if (std::fabs(d.z) >= std::fabs(d[kz])) kz = 2;
  int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
  if (d[kz] < 0) std::swap(kx, ky);
  const float sx = d[kx] / d[kz], sy = d[ky] / d[kz], sz = 1.0f / d[kz];
  float x[3], y[3], z[3];
  double e[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = p[i] - ray.origin;
    x[i] = a[kx] - sx * a[kz], y[i] = a[ky] - sy * a[kz], z[i] = sz * a[kz];
  }
  const auto edges = [&]<class T>(T) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 2) % 3, k = (i + 1) % 3;
      e[i] = T{x[j]} * T{y[k]} - T{y[j]} * T{x[k]};
    }
  };
  // Exact products, all scaled by one power of two if they are too large or too small for their quotients.
  const auto exact_edges = [&] {
    edges(0.0);
    const double most = std::max({std::fabs(e[0]), std::fabs(e[1]), std::fabs(e[2])});
    if (std::isfinite(most) && most > 0 && (most < 0x1p-100 || most > 0x1p100))
      for (double& edge : e) edge = std::ldexp(edge, -std::ilogb(most));
  };
  edges(0.0f);
  if (e[0] == 0 || e[1] == 0 || e[2] == 0) exact_edges();
  const double sum = std::fabs(e[0] + (e[1] + e[2]));
  if (sum != 0 && !(sum >= 0x1p-100 && sum <= 0x1p100)) exact_edges();
  if (std::min({e[0], e[1], e[2]}) < 0 && std::max({e[0], e[1], e[2]}) > 0) return false;
  const auto u = static_cast<float>(e[0]), v = static_cast<float>(e[1]), w = static_cast<float>(e[2]);
  const float det = u + (v + w);
  if (det == 0) return false;
  const float t = (u * z[0] + (v * z[1] + w * z[2])) * (1.0f / det);
  return t >= ray.tmin && t <= std::numeric_limits<float>::max();
}

// That is why a surface is as closed as it was when the float's distance was reported.
TEST(PreciseDistance, NothingThatTheFloatHitsIsLost) {
  CaseRandom random(run_seed(), 901, 0);
  std::size_t hits = 0, ahead_by_rounding = 0;
  for (int i = 0; i < scaled(200'000, 20'000); ++i) {
    TriangleCase c = triangle_case(static_cast<TriangleCaseKind>(i % kTriangleCaseKinds), random);
    c.ray.tmax = kInfinity;
    if (!valid(c.ray) || !std::isfinite(c.ray.tmin)) continue;
    Aabb box;
    for (const Vec3& corner : c.corners) box.extend(corner);
    float entry;
    if (!float_hits(c.ray, c.corners) || !slab(SlabRay(c.ray), box, kInfinity, entry)) continue;
    const Hit hit = OneLeaf({&c.corners, 1}).hit(c.ray, AccuracyConfig{});
    EXPECT_TRUE(hit.valid()) << i << " CAROUSEL_SEED=" << run_seed();
    ++hits;
    ahead_by_rounding += hit.t == c.ray.tmin;
  }
  EXPECT_GT(hits, 3000u);
  EXPECT_GT(ahead_by_rounding, 10u);  // or it is not seen that the float decides
}

// The distance is below the largest float as fp32 computes it, and above it as fp64 does.
TEST(PreciseDistance, AHitAtTheLargestFloatIsNotLost) {
  const Corners corners = {Vec3{-0x1.b3aaeap-81f, -0x1.e54abp+21f, -0x1.0b4becp+2f},
                           Vec3{-0x1.8bdc4cp-89f, 0x1.7eb0c4p-10f, -0x1.d626c6p-31f},
                           Vec3{-0x1.ebb4e2p-46f, -0x1.6bd08p-88f, 0x1.2af81cp-62f}};
  const Ray ray{.origin = {-0x1.12b848p-56f, 0x1.33138cp-86f, -0x1.7b0eep+33f},
                .direction = {-0.0f, -0x1.20d608p-108f, 0x1.7b0eep-95f}};
  ASSERT_TRUE(float_hits(ray, corners));
  EXPECT_EQ(OneLeaf({&corners, 1}).hit(ray, AccuracyConfig{}).t, std::numeric_limits<float>::max());
}

}  // namespace
}  // namespace carousel::accel
