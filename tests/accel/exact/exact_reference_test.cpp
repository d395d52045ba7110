#include "accel/traverse/exact_reference.h"

#include <bit>
#include <chrono>
#include <iostream>
#include <optional>
#include <type_traits>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "accel/exact/crossing_filter.h"
#include "accel/exact/exact_crossing.h"
#include "accel/traverse/verifying_workload.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/exact/exact_oracle.h"
#include "tests/accel/structure/placements.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Rational = boost::multiprecision::cpp_rational;

Rational rational(double x) {
  return Rational(x);
}
Rational rational(const Dyadic& x) {
  Rational r(x.integer());
  const Rational power(Dyadic::Int(1) << std::abs(x.exponent()));
  return x.exponent() < 0 ? Rational(r / power) : Rational(r * power);
}

TEST(Dyadic, AddsAndMultipliesWithoutRounding) {
  Random random(run_seed() + 700);
  for (int i = 0; i < 20000; ++i) {
    double x[3];
    for (double& v : x) {
      v = random.any_bits();
      if (!std::isfinite(v)) v = 0;
      if (i % 3 == 0) v = std::ldexp(v, static_cast<int>(random.below(100)) - 50) * 1.000000001;
    }
    const Dyadic a(x[0]), b(x[1]), c(x[2]);
    ASSERT_EQ(rational(a), rational(x[0]));
    ASSERT_EQ(rational(a * b - c + a), Rational(rational(x[0]) * rational(x[1]) - rational(x[2]) + rational(x[0])));
  }
}

// Nearest means: neither neighbour is nearer, and on a tie the even one was taken.
template <class Real>
void expect_nearest(const Dyadic& n, const Dyadic& d, Real got) {
  const Rational exact = rational(n) / rational(d);
  ASSERT_TRUE(std::isfinite(got));
  const Rational off = abs(Rational(exact - rational(double(got))));
  for (const Real other : {std::nextafter(got, -std::numeric_limits<Real>::infinity()),
                           std::nextafter(got, std::numeric_limits<Real>::infinity())}) {
    if (!std::isfinite(other)) continue;
    const Rational there = abs(Rational(exact - rational(double(other))));
    ASSERT_LE(off, there);
    using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
    if (off == there) {
      ASSERT_EQ(std::bit_cast<Bits>(got) & 1, 0u);
    }
  }
}

TEST(Dyadic, RatiosRoundToTheNearest) {
  Random random(run_seed() + 701);
  for (int i = 0; i < 20000; ++i) {
    const float x = random.uniform(-3, 3), y = random.uniform(1, 2);
    const int shift = static_cast<int>(random.below(160)) - 155;
    Dyadic n(std::ldexp(double{x}, i % 2 ? shift : 0)), d(y);
    if (i % 3 == 0)
      d = Dyadic(1), n = Dyadic(double{x}) + Dyadic(std::ldexp(double(i % 6 ? 1 : -1), -25));  // ties among them
    if (i % 5 == 0) n = n * Dyadic(1.0 / 3), d = d * Dyadic(-1.1);
    if (n.sign() == 0) continue;
    expect_nearest<float>(n, d, rounded_ratio<float>(n, d));
    expect_nearest<double>(n, d, rounded_ratio<double>(n, d));
  }
  EXPECT_EQ(rounded_ratio<float>(Dyadic(std::ldexp(1.0, -149)), Dyadic(2.0)), 0.0f);  // a tie with 0, even
  EXPECT_EQ(rounded_ratio<float>(Dyadic(std::ldexp(3.0, -149)), Dyadic(2.0)), std::ldexp(2.0f, -149));
  EXPECT_EQ(rounded_ratio<float>(Dyadic(1e300), Dyadic(1.0)), kInfinity);
}

/// Computes hits by their definition, in fractions, triangle after triangle.
class SlowReference {
 public:
  struct Answer {
    std::uint32_t instance = kNoInstance, primitive = 0;
    std::optional<Rational> t;
    bool tie = false;
  };

  explicit SlowReference(const scene::Scene& scene) {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Affine& m = scene.instances[i].world_from_model;
      const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
      for (std::uint32_t k = 0; k < mesh.triangle_count(); ++k) {
        Triangle t{i, k, {}, {}};
        for (std::size_t v = 0; v < 3; ++v) {
          t.p[v] = exact(m.translation);
          for (std::size_t row = 0; row < 3; ++row)
            for (int c = 0; c < 3; ++c)
              t.p[v][row] +=
                  Rational(m.linear[c][static_cast<int>(row)]) * Rational(mesh.positions[mesh.indices[3 * k + v]][c]);
        }
        t.n = cross(sub(t.p[1], t.p[0]), sub(t.p[2], t.p[0]));
        triangles_.push_back(t);
      }
    }
  }

  Answer closest(const Ray& ray) const {
    const Vec o = exact(ray.origin), d = exact(ray.direction);
    Answer out;
    for (const Triangle& triangle : triangles_) {
      const auto& [a, b, c] = triangle.p;
      const Rational facing = dot(triangle.n, d);
      if (facing == 0) continue;
      // Inside by solving for the crossing point first: another road than the volumes of exact_crossing.
      const Rational t = dot(triangle.n, sub(a, o)) / facing;
      if (t < Rational(ray.tmin) || (std::isfinite(ray.tmax) && t > Rational(ray.tmax)) || (out.t && t > *out.t))
        continue;
      const Vec x{o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
      if (dot(triangle.n, cross(sub(b, a), sub(x, a))) < 0 || dot(triangle.n, cross(sub(c, b), sub(x, b))) < 0 ||
          dot(triangle.n, cross(sub(a, c), sub(x, c))) < 0)
        continue;
      if (out.t && *out.t == t)
        out.tie = true;  // the first in order stays
      else
        out = {triangle.instance, triangle.primitive, t, false};
    }
    return out;
  }

 private:
  using Vec = std::array<Rational, 3>;
  struct Triangle {
    std::uint32_t instance, primitive;
    std::array<Vec, 3> p;
    Vec n;
  };
  static Vec exact(const Vec3& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
  static Vec sub(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Rational dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  std::vector<Triangle> triangles_;
};

TEST(ExactReference, AgreesWithFractions) {
  std::size_t hits = 0, ties = 0;
  for (const auto& builtin : kEnumNames<BuiltinScene>) {
    if (builtin.value == BuiltinScene::kGaussians) continue;  // no surfaces
    scene::Scene scene = small_builtin(builtin.value, 60, 3);
    for (scene::Mesh& mesh : scene.meshes) mesh.indices.resize(std::min<std::size_t>(mesh.indices.size(), 3 * 40));
    if (builtin.value == BuiltinScene::kInstances)  // one that is baked
      scene.instances[1].world_from_model.linear[2] = scene.instances[1].world_from_model.linear[0];
    const ExactReference reference(scene);
    const SlowReference slow_reference(scene);
    for (const RayRequest& r : mixed_rays(scene, 60, run_seed() + 710)) {
      const SlowReference::Answer slow = slow_reference.closest(r.ray);
      const ExactHit got = reference.closest(r.ray);
      ASSERT_EQ(got.hit.instance, slow.instance) << builtin.name;
      if (!slow.t) continue;
      ++hits;
      ties += slow.tie;
      ASSERT_EQ(got.hit.primitive, slow.primitive) << builtin.name;
      ASSERT_EQ(got.tie, slow.tie) << builtin.name;
      const Rational off = abs(Rational(rational(got.t) - *slow.t));
      ASSERT_LE(off, abs(Rational(rational(std::nextafter(got.t, -1.0)) - *slow.t))) << builtin.name;
      ASSERT_LE(off, abs(Rational(rational(std::nextafter(got.t, HUGE_VAL)) - *slow.t))) << builtin.name;
    }
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(ties, 5u);  // rays at shared edges and vertices
}

// The filter must be sure of what is so only, however large or small the numbers, and of most of it.
TEST(ExactReference, FilterIsNeverWrong) {
  Random random(run_seed() + 720);
  std::size_t sure = 0, unsure = 0, hits = 0;
  for (int i = 0; i < scaled(15000, 3500); ++i) {
    const float size = std::ldexp(1.0f, static_cast<int>(random.below(i % 2 ? 8 : 120)) - (i % 2 ? 4 : 60));
    std::array<Vec3, 3> p;
    for (Vec3& v : p) v = size * random.in_box(Vec3{-1}, Vec3{1});
    scene::Affine m;
    if (i % 3)
      m = {Mat3(random.in_box(Vec3{-1}, Vec3{1}), random.in_box(Vec3{-1}, Vec3{1}), random.in_box(Vec3{-1}, Vec3{1})),
           size * (i % 5 ? 1.0f : 1e5f) * random.in_box(Vec3{-1}, Vec3{1})};
    const DVec3 a = DMat3(m.linear) * DVec3(p[0]) + DVec3(m.translation),
                b = DMat3(m.linear) * DVec3(p[1]) + DVec3(m.translation);
    const double s = i % 4 ? random.uniform() : 0;
    const Vec3 from(a + double{size} * DVec3(random.in_box(Vec3{-3}, Vec3{3})));
    // At an edge or vertex, or anywhere near.
    const Vec3 at(a + s * (b - a) + (i % 7 ? 0.0 : double{size}) * DVec3(random.in_box(Vec3{-1}, Vec3{1})));
    const Ray ray{from, 0, at - from, kInfinity};
    if (ray.direction == Vec3{0}) continue;
    const FilteredCrossing got = filtered_crossing(ray, p, m);
    const std::optional<ExactCrossing> exact = exact_crossing(ray, p, m);
    if (got.verdict == FilteredCrossing::Verdict::kUnsure) {
      ++unsure;
      continue;
    }
    ++sure;
    ASSERT_EQ(got.verdict == FilteredCrossing::Verdict::kHit, exact.has_value()) << i;
    if (!exact) continue;
    ++hits;
    ASSERT_GE(exact->compare(got.t_lo), 0) << i;
    ASSERT_LE(exact->compare(got.t_hi), 0) << i;
  }
  std::cout << sure << " decided by the filter, " << hits << " hits; " << unsure << " left to exact arithmetic\n";
  EXPECT_GT(sure, unsure);
  EXPECT_GT(hits, 1000u);
}

// Where the tracer's answer is another one, it is one that a ray within the documented bound has.
TEST(ExactReference, OracleExplainsWhereTheTracerDiffers) {
  std::vector<std::pair<std::string, scene::Scene>> scenes;
  for (const auto& builtin : kEnumNames<BuiltinScene>)
    if (builtin.value != BuiltinScene::kGaussians)  // no surfaces
      scenes.emplace_back(builtin.name, small_builtin(builtin.value, 600, 12));
  scenes.emplace_back("ball at the patent's matrix", icosphere_scene(2));
  scenes.back().second.instances[0].world_from_model = patent_placements()[1];
  for (const auto& [name, scene] : scenes) {
    const Accel accel = build_sequential(scene);
    const ExactReference reference(scene);
    const ExactOracle oracle(scene);
    RayBatch rays;  // the oracle knows whole rays from outside the surface
    for (const RayRequest& r : whole_rays(scene, static_cast<std::size_t>(scaled(4000)), run_seed() + 730))
      if (rays.size() % 6 != 4)
        rays.push_back(r);
      else
        rays.push_back(ray_to(r.ray.origin - r.ray.direction, r.ray.direction));
    std::size_t others = 0, hits = 0;
    std::vector<double> ulps;
    for (const RayResult& r : trace(accel, rays)) {
      const ExactHit exact = reference.closest(r.ray);
      if (exact.hit.valid() && r.hit.valid() && exact.hit.instance == r.hit.instance &&
          exact.hit.primitive == r.hit.primitive) {
        ++hits;
        ulps.push_back(std::fabs(r.hit.t - exact.t) / (std::nextafter(exact.hit.t, kInfinity) - exact.hit.t));
        continue;
      }
      if (!exact.hit.valid() && !r.hit.valid()) continue;
      ++others;
      EXPECT_TRUE(oracle.acceptable(r.ray, r.hit)) << name;
      EXPECT_TRUE(oracle.acceptable(r.ray, exact.hit)) << name;
    }
    ASSERT_GT(hits, 100u);
    std::sort(ulps.begin(), ulps.end());
    std::cout << name << ": " << hits << " alike, " << others << " other hits; t off by " << ulps[ulps.size() / 2]
              << " ulp (median), " << ulps.back() << " (most)\n";
  }
}

TEST(ExactReference, StatesItsCost) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin, 20000, 100);
    const ExactReference reference(scene);
    const RayBatch rays = whole_rays(scene, 3000, run_seed() + 740);
    std::size_t hits = 0;
    const auto start = std::chrono::steady_clock::now();
    for (const RayRequest& r : rays) hits += reference.closest(r.ray).hit.valid();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::cout << enum_name(builtin) << ": " << static_cast<double>(rays.size()) / seconds.count() << " rays/s\n";
    EXPECT_GT(hits, rays.size() / 5);
  }
}

}  // namespace
}  // namespace carousel::accel
