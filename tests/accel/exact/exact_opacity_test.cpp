// The exact reference where it is more than triangles: spheres, primitives that may let rays through, and culled sides,
// against every primitive solved in turn with a hundred digits.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "accel/exact/exact_root.h"
#include "accel/traverse/exact_reference.h"
#include "accel/traverse/ray_check.h"
#include "core/numeric/octahedral.h"
#include "scene/model/opacity.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/support/random_runs.h"

namespace carousel::accel::exact_opacity_test {
namespace {

using Big = boost::multiprecision::cpp_bin_float_100;

struct BigVec {
  Big x, y, z;
};
BigVec big(const Vec3& v) {
  return {v.x, v.y, v.z};
}
BigVec operator-(const BigVec& a, const BigVec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Big dot(const BigVec& a, const BigVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
BigVec cross(const BigVec& a, const BigVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// By Cramer's rule.
BigVec solve(const Mat3& m, const BigVec& b) {
  const BigVec x = big(m[0]), y = big(m[1]), z = big(m[2]);
  const Big whole = dot(x, cross(y, z));
  return {dot(b, cross(y, z)) / whole, dot(x, cross(b, z)) / whole, dot(x, cross(y, b)) / whole};
}

struct Met {
  Big t;
  std::uint32_t instance, primitive;
  float u, v;
  bool front, may_pass;
};

/// All crossings of the ray, each in the space of its model.
std::vector<Met> all_met(const scene::Scene& scene, const Ray& ray) {
  const scene::Opacity opacity(scene);
  std::vector<Met> met;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Affine& m = scene.instances[i].world_from_model;
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
    const BigVec o = solve(m.linear, big(ray.origin) - big(m.translation)), d = solve(m.linear, big(ray.direction));
    for (std::uint32_t k = 0; k < mesh.triangle_count(); ++k) {
      const auto corner = [&](std::uint32_t c) { return big(mesh.positions[mesh.indices[3 * k + c]]); };
      const BigVec a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a, p = cross(d, e2), s = o - a;
      const Big whole = dot(e1, p);
      if (whole == 0) continue;
      const BigVec q = cross(s, e1);
      const Big u = dot(s, p) / whole, v = dot(d, q) / whole;
      if (u < 0 || v < 0 || u + v > 1) continue;
      met.push_back({dot(e2, q) / whole, i, k, float(u), float(v), dot(d, cross(e1, e2)) < 0,
                     opacity.may_be_non_opaque(mesh, k)});
    }
    for (std::uint32_t k = 0; k < mesh.spheres.size(); ++k) {
      const scene::Sphere& sphere = mesh.spheres[k];
      const BigVec f = o - big(sphere.center);
      const Big a = dot(d, d), b = dot(f, d), c = dot(f, f) - Big(sphere.radius) * sphere.radius,
                square = b * b - a * c;
      if (square < 0) continue;
      for (const int side : {-1, 1}) {
        const Big t = (-b + side * sqrt(square)) / a, r = sphere.radius;
        const DVec3 normal(double((f.x + t * d.x) / r), double((f.y + t * d.y) / r), double((f.z + t * d.z) / r));
        const Vec2 where = octahedral(normal);
        met.push_back({t, i, static_cast<std::uint32_t>(mesh.triangle_count()) + k, where.x, where.y, side < 0,
                       opacity.may_be_non_opaque(sphere)});
      }
    }
  }
  std::sort(met.begin(), met.end(), [](const Met& a, const Met& b) {
    return std::tie(a.t, a.instance, a.primitive) < std::tie(b.t, b.instance, b.primitive);
  });
  return met;
}

TEST(ExactReference, AsksWhatMayPassAndKnowsSpheresAndCulledSides) {
  const HashedStop stop(0.4);
  std::size_t hits = 0, spheres = 0, passed = 0, culled = 0;
  for (const BuiltinScene builtin : {BuiltinScene::kSpheres, BuiltinScene::kInstances}) {
    const scene::Scene scene = passing_scene(builtin, 20, run_seed() + 760);
    const ExactReference reference(scene, &stop);
    const RayBatch rays = wishing_rays(scene, static_cast<std::size_t>(scaled(24, 24)), run_seed() + 761);
    for (const RayRequest& r : rays) {
      // At edges and corners a hundred digits do not decide.
      RayRequest off = r;
      off.ray.direction += 1e-3f * Vec3{0.3f, -0.7f, 0.5f} * (std::fabs(r.ray.direction.x) + 1e-3f);
      const std::uint8_t flags = off.tag.flags;
      Hit expected;
      for (const Met& m : all_met(scene, off.ray)) {
        if (m.t < off.ray.tmin || m.t > off.ray.tmax) continue;
        if ((flags & (m.front ? kRayCullFront : kRayCullBack)) != 0) {
          ++culled;
          continue;
        }
        if (m.may_pass && (flags & kRayForceOpaque) == 0 && !stop.accepts(off.ray, m.instance, m.primitive, m.u, m.v)) {
          ++passed;
          continue;
        }
        expected = {float(m.t), m.u, m.v, m.instance, m.primitive};
        break;
      }
      const Hit got = reference.closest(off.ray, flags).hit;
      ASSERT_EQ(got.instance, expected.instance) << "seed " << run_seed();
      if (!got.valid()) continue;
      ++hits;
      spheres += got.primitive >= scene.meshes[scene.instances[got.instance].mesh.value].triangle_count();
      ASSERT_EQ(got.primitive, expected.primitive);
      ASSERT_EQ(got.t, expected.t);
      ASSERT_EQ(got.u, expected.u);
      ASSERT_EQ(got.v, expected.v);
    }
  }
  EXPECT_GT(hits, 12u);
  EXPECT_GT(spheres, 3u);
  EXPECT_GT(passed, 5u);
  EXPECT_GT(culled, 5u);
}

// Two instances of one ball: the same surface under two names, whose roots are other numbers of the same value.
TEST(ExactReference, SpheresThatCoincideTie) {
  scene::Scene scene = empty_scene();
  scene.meshes.emplace_back().spheres.push_back({Vec3{0}, 1, MaterialId(0)});
  scene.meshes.emplace_back().spheres.push_back({Vec3{0}, 3, MaterialId(0)});
  add_instance(scene, 1);
  add_instance(scene, 0, {Mat3(3.0f), Vec3{0}});
  const ExactReference reference(scene);
  const ExactHit inside = reference.closest(ray_to({0.1f, 0.2f, 0.3f}, {0.7f, 0.1f, -0.5f}).ray);
  EXPECT_EQ(inside.hit.instance, 0u);
  EXPECT_TRUE(inside.tie);
  const ExactHit touching = reference.closest(ray_to({3, 0, -5}, {0, 0, 1}).ray);
  EXPECT_EQ(touching.hit.instance, 0u);
  EXPECT_EQ(touching.t, 5.0);
  EXPECT_FALSE(reference.closest(ray_to({std::nextafter(3.0f, 4.0f), 0, -5}, {0, 0, 1}).ray).hit.valid());
}

Big big(const Dyadic& x) {
  return ldexp(Big(x.integer()), x.exponent());
}
Big big(const ExactRoot& r) {
  return (big(r.rational) + r.side * sqrt(big(r.square))) / big(r.denominator);
}

TEST(ExactRoot, ComparesAndRoundsAsAHundredDigits) {
  Random random(run_seed() + 770);
  const auto root = [&] {
    const auto number = [&] { return Dyadic(double{random.uniform(-4, 4)}) * Dyadic(double{random.uniform(-4, 4)}); };
    const Dyadic half = number(), size = number();
    ExactRoot r{half, size * size + Dyadic(0x1p-30), static_cast<int>(random.below(3)) - 1, Dyadic()};
    const Dyadic square = number();
    r.square = random.below(4) == 0 ? square * square : square.sign() < 0 ? -square : square;
    return r;
  };
  for (int i = 0; i < 2000; ++i) {
    const ExactRoot a = root(), b = root();
    const Big x = big(a), y = big(b);
    ASSERT_EQ(a.compare(b), x < y ? -1 : 1);
    const Dyadic factor(double{random.uniform(0.1f, 9)});
    const ExactRoot same{a.rational * factor, a.denominator * factor, a.side, a.square * factor * factor};
    ASSERT_EQ(a.compare(same), 0);
    ASSERT_EQ(a.compare(double(x) * (1 + 1e-12) + 1e-12), x < double(x) * (1 + 1e-12) + 1e-12 ? -1 : 1);
    ASSERT_EQ(a.rounded<float>(), float(x));
    ASSERT_EQ(a.rounded<double>(), double(x));
  }
  const ExactRoot nought{Dyadic(-3.0), Dyadic(1.0), 1, Dyadic(9.0)};
  EXPECT_EQ(nought.compare(0), 0);
  EXPECT_EQ(nought.rounded<float>(), 0.0f);
  EXPECT_EQ(nought.compare(kInfinity), -1);
}

}  // namespace
}  // namespace carousel::accel::exact_opacity_test
