#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/placement_cases.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/triangle_cases.h"
#include "accel/certificate/triangle_oracle.h"
#include "accel/exact/exact_triangle.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

/// Of a crossing that the oracle knows: where it lies in the ray's range.
struct Range {
  bool inside,
      at_an_end;  ///< at_an_end: outside by so little that the nearest float is the end, and either answer is right

  Range(const TriangleOracle& oracle, const Ray& ray) {
    const float last = std::min(ray.tmax, kLargest);
    const bool early = oracle.hit() && oracle.compare_t(ray.tmin) < 0,
               late = oracle.hit() && oracle.compare_t(last) > 0;
    inside = oracle.hit() && !early && !late;
    at_an_end = (early && oracle.t_is_nearest(ray.tmin)) || (late && oracle.t_is_nearest(last));
  }
};

double ulps(float got, double exact) {
  const float size = std::fabs(static_cast<float>(exact));
  return std::fabs(got - exact) / (double{std::nextafter(size, kInfinity)} - size);
}

std::string described(const TriangleOracle& oracle) {
  if (!oracle.hit()) return "not crossed";
  return fmt::format("crossed at t = {:.17g}, u = {:.17g}, v = {:.17g}", oracle.t(), oracle.u(), oracle.v());
}

CaseValues make_triangle(CaseRandom& random) {
  const TriangleCase c = triangle_case(static_cast<TriangleCaseKind>(random.below(kTriangleCaseKinds)), random);
  return CaseWriter().add(c.ray).add(c.corners[0]).add(c.corners[1]).add(c.corners[2]).take();
}

void judge_triangle(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                    CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const bool finite = read.rest_is_finite();
  const Corners corners{read.vector(), read.vector(), read.vector()};
  if (!valid(ray) || !std::isfinite(ray.tmin) || !finite) return;
  const TriangleOracle oracle(ray, corners);
  const Range range(oracle, ray);
  OneLeaf leaf({&corners, 1});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    // Boxes in double miss nothing at any exponent, so that only the triangle test is judged.
    AccuracyConfig level = levels[i];
    level.box = BoxLevel::kDouble;
    const Hit hit = leaf.hit(ray, level);
    Judgement& judgement = out[i];
    judgement.applies = !range.at_an_end;
    judgement.broken = !range.at_an_end && hit.valid() != range.inside;
    if (hit.valid() && range.inside) judgement.error = ulps(hit.t, oracle.t());
    if (story != nullptr) *story = {text(hit), described(oracle)};
    if (level.triangle != TriangleLevel::kExact) continue;
    NearestCrossing crossing{};
    const bool crossed = exact_triangle(ray, corners, crossing);
    judgement.broken |= crossed != oracle.hit();
    if (crossed && oracle.hit())
      judgement.broken |=
          !oracle.t_is_nearest(crossing.t) || !oracle.u_is_nearest(crossing.u) || !oracle.v_is_nearest(crossing.v);
    if (hit.valid() && crossed) judgement.broken |= hit.t < crossing.t || hit.u != crossing.u || hit.v != crossing.v;
    if (story != nullptr && crossed)
      story->kernel += fmt::format("; by itself crossed at t = {}, u = {}, v = {}", text(crossing.t), text(crossing.u),
                                   text(crossing.v));
  }
}

/// Two pyramids on one base: closed as every edge belongs to two of the triangles.
std::vector<Corners> bipyramid(const Vec3& apex, const Vec3& nadir, std::span<const Vec3> ring) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 a = ring[i], b = ring[(i + 1) % ring.size()];
    triangles.push_back({apex, a, b});
    triangles.push_back({nadir, b, a});
  }
  return triangles;
}

constexpr std::size_t kLeastRing = 3, kMostRing = 8;

CaseValues make_closed_mesh(CaseRandom& random) {
  const std::size_t sides = kLeastRing + random.below(kMostRing - kLeastRing + 1);
  // Flattened and moved away, but never so far that the corners' rounding could turn it inside out.
  const int flat = static_cast<int>(random.below(12)),
            away = random.below(2) ? static_cast<int>(random.below(static_cast<std::uint32_t>(16 - flat))) : -100;
  DVec3 scale(1);
  if (random.below(2)) scale[static_cast<int>(random.below(3))] = std::ldexp(1.0, -flat);
  const double size = std::ldexp(1.0, static_cast<int>(random.below(60)) - 30);
  const DMat3 turn = random.below(3) ? rotation(random_direction(random), 360.0 * random.uniform()) : DMat3(1.0);
  const DVec3 centre = std::ldexp(1.0, away) * random_direction(random);
  const auto world = [&](const DVec3& p) { return Vec3(size * (centre + turn * (scale * p))); };

  std::vector<Vec3> corners{world({0, 0, random.uniform(0.5f, 1)}), world({0, 0, -random.uniform(0.5f, 1)})};
  for (std::size_t i = 0; i < sides; ++i) {
    const double angle =
        2 * std::numbers::pi * (static_cast<double>(i) + random.uniform(-0.25f, 0.25f)) / static_cast<double>(sides);
    const double radius = random.uniform(0.7f, 1.4f);
    corners.push_back(world({radius * std::cos(angle), radius * std::sin(angle), random.uniform(-0.2f, 0.2f)}));
  }
  // An edge: from an apex to the base, or along the base.
  const auto first = random.below(static_cast<std::uint32_t>(corners.size())),
             side = random.below(static_cast<std::uint32_t>(sides));
  const Vec3 a = corners[first], b = corners[2 + (first < 2 ? side : (first - 1) % sides)];
  const std::uint32_t how = random.below(4);
  const Vec3 at = how == 0 ? a : how == 1 ? 0.5f * (a + b) : a + random.uniform() * (b - a);
  Ray ray;
  ray.origin = world(random.below(5) ? DVec3(random.in_box(Vec3{-0.12f}, Vec3{0.12f})) : DVec3(0));
  ray.direction = nudged(at - ray.origin, how == 3 ? 1 : 0, random);
  CaseWriter out;
  out.add(ray);
  for (const Vec3& corner : corners) out.add(corner);
  return out.take();
}

void judge_closed_mesh(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                       CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const bool finite = read.rest_is_finite();
  const Vec3 apex = read.vector(), nadir = read.vector();
  std::vector<Vec3> ring;
  while (read.more()) ring.push_back(read.vector());
  if (!valid(ray) || ray.tmin != 0 || ray.tmax != kInfinity || !finite) return;
  const std::vector<Corners> triangles = bipyramid(apex, nadir, ring);
  // Something ahead and something behind: the origin is inside.
  std::size_t ahead = 0, behind = 0;
  for (const Corners& corners : triangles) {
    const TriangleOracle oracle(ray, corners);
    if (!oracle.hit()) continue;
    ahead += oracle.compare_t(0) > 0 && oracle.compare_t(kLargest) <= 0;
    behind += oracle.compare_t(0) < 0;
  }
  OneLeaf leaf(triangles);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Hit hit = leaf.hit(ray, levels[i]);
    out[i].applies = ahead > 0 && behind > 0;
    out[i].broken = out[i].applies && !hit.valid();
    if (story != nullptr)
      *story = {text(hit), fmt::format("{} of {} triangles crossed ahead, {} behind", ahead, triangles.size(), behind)};
  }
}

}  // namespace

Property triangle_property() {
  return {"triangle",
          3,
          "a triangle is hit where the exact ray crosses it; exact: t, u and v are the nearest floats",
          "ulp of t",
          {AccuracyKey::kTriangle},
          ray_and({{"a", 3}, {"b", 3}, {"c", 3}}),
          [](const AccuracyConfig& level) { return level.triangle == TriangleLevel::kExact; },
          make_triangle,
          judge_triangle};
}

Property closed_mesh_property() {
  return {"closed_mesh",
          4,
          "from inside a closed mesh something is hit",
          "",
          {AccuracyKey::kTriangle, AccuracyKey::kBox},
          ray_and({{"apex", 3}, {"nadir", 3}, {"ring", 3 * kLeastRing, 3 * kMostRing}}),
          [](const AccuracyConfig& level) {
            return level.triangle != TriangleLevel::kFast && level.box != BoxLevel::kPlain;
          },
          make_closed_mesh,
          judge_closed_mesh};
}

}  // namespace carousel::accel
