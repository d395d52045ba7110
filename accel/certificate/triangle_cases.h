#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "accel/certificate/adversarial_numbers.h"
#include "accel/certificate/case_random.h"
#include "accel/certificate/case_values.h"
#include "accel/traverse/ray_check.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// A ray and a triangle made to be hard to decide.
struct TriangleCase {
  Ray ray;
  std::array<Vec3, 3> corners;
};

/// The ray and the triangle of a case's numbers; absent where they promise nothing, as numbers are not finite.
inline std::optional<TriangleCase> judged_triangle(const CaseValues& values) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const bool finite = read.rest_is_finite();
  const TriangleCase out{ray, {read.vector(), read.vector(), read.vector()}};
  return valid(ray) && std::isfinite(ray.tmin) && finite ? std::optional(out) : std::nullopt;
}

/// How many units of the last place of the exact number, as a float, another one is off.
inline double ulps_between(float got, double exact) {
  const float size = std::fabs(static_cast<float>(exact));
  return std::fabs(got - exact) / (double{std::nextafter(size, std::numeric_limits<float>::infinity())} - size);
}

enum class TriangleCaseKind {
  kRandom,
  kEdgeAimed,  ///< at a point of an edge, some ulps off
  kCornerAimed,
  kGrid,           ///< small whole numbers: on edges, in planes, without area
  kScaledGrid,     ///< as kGrid, times a power of two for each axis
  kWildExponents,  ///< anything from 2^-149 to 2^128
  kSliver,
  kDegenerate,  ///< corners that coincide or stand on a line
  kEdgeOn,      ///< in the triangle's plane, some ulps off
  kOnSurface,   ///< starts on the triangle
};
inline constexpr int kTriangleCaseKinds = 10;

template <class Random>
TriangleCase triangle_case(TriangleCaseKind kind, Random& random) {
  TriangleCase c;
  auto& p = c.corners;
  for (Vec3& corner : p) corner = random.in_box(Vec3{-1}, Vec3{1});
  c.ray.origin = random.in_box(Vec3{-3}, Vec3{3});
  const float s = random.uniform();
  Vec3 aim = p[0] + s * (p[1] - p[0]);
  switch (kind) {
    case TriangleCaseKind::kRandom:
      aim = random.in_box(Vec3{-1}, Vec3{1});
      break;
    case TriangleCaseKind::kEdgeAimed:
      break;
    case TriangleCaseKind::kCornerAimed:
      aim = p[random.below(3)];
      break;
    case TriangleCaseKind::kGrid:
    case TriangleCaseKind::kScaledGrid: {
      for (Vec3& corner : p) corner = grid_point(random, 3);
      c.ray.origin = grid_point(random, 4);
      c.ray.direction = random.below(2) ? grid_point(random, 2) : p[random.below(3)] - c.ray.origin;
      if (kind == TriangleCaseKind::kGrid) return c;
      // Signs and zeros of determinants survive other units on each axis; t with another unit of direction scales.
      Vec3 unit;
      for (int axis = 0; axis < 3; ++axis) unit[axis] = std::ldexp(1.0f, static_cast<int>(random.below(240)) - 120);
      for (Vec3* v : {&p[0], &p[1], &p[2], &c.ray.origin, &c.ray.direction}) *v = *v * unit;
      return c;
    }
    case TriangleCaseKind::kWildExponents: {
      // Wild alone almost never hits: the aim is a mean of wild corners, and some numbers are wild afterwards.
      for (Vec3& corner : p) corner = {wild(random) * 0.25f, wild(random) * 0.25f, wild(random) * 0.25f};
      const float u = random.uniform(), v = random.uniform() * (1 - u);
      c.ray.origin = random.below(3) ? Vec3{wild(random), wild(random), wild(random)} * 0.25f : Vec3{0};
      c.ray.direction = (p[0] * (1 - u - v) + p[1] * u + p[2] * v) - c.ray.origin;
      if (random.below(4) == 0)
        c.ray.direction = c.ray.direction * std::ldexp(1.0f, -static_cast<int>(random.below(140)));
      if (random.below(8) == 0) p[random.below(3)][static_cast<int>(random.below(3))] = wild(random);
      return c;
    }
    case TriangleCaseKind::kSliver:
      p[2] = nudged(p[0] + random.uniform() * (p[1] - p[0]), 3, random);
      aim = nudged(aim, 2, random);
      break;
    case TriangleCaseKind::kDegenerate: {
      const Vec3 a = grid_point(random, 50), step = grid_point(random, 3);
      for (Vec3& corner : p) corner = (a + step * static_cast<float>(random.below(5))) * 0x1p-6f;
      aim = p[random.below(3)];
      c.ray.origin = grid_point(random, 100) * 0x1p-6f;
      break;
    }
    case TriangleCaseKind::kEdgeOn: {
      // On a grid fine enough for the sums to be exact.
      for (Vec3& corner : p) corner = grid_point(random, 1000) * 0x1p-10f;
      const float a = static_cast<float>(static_cast<int>(random.below(9)) - 4),
                  b = static_cast<float>(static_cast<int>(random.below(9)) - 4);
      c.ray.origin = p[0] + a * (p[1] - p[0]) + b * (p[2] - p[0]);
      c.ray.direction = p[random.below(3)] - c.ray.origin;
      if (random.below(4)) c.ray.direction = nudged(c.ray.direction, 1, random);
      if (random.below(4)) c.ray.origin = nudged(c.ray.origin, 1, random);
      return c;
    }
    case TriangleCaseKind::kOnSurface: {
      const float u = random.below(2) ? random.uniform() : 0.0f;  // or on an edge
      c.ray.origin = nudged(p[0] + s * (1 - u) * (p[1] - p[0]) + u * (p[2] - p[0]), 1, random);
      c.ray.direction = random.in_box(Vec3{-1}, Vec3{1});
      return c;
    }
  }
  c.ray.direction = nudged(aim - c.ray.origin, 2, random);
  return c;
}

/// The values of a case of any of these kinds: a ray and three corners.
inline CaseValues make_triangle(CaseRandom& random) {
  const TriangleCase c = triangle_case(static_cast<TriangleCaseKind>(random.below(kTriangleCaseKinds)), random);
  return CaseWriter().add(c.ray).add(c.corners[0]).add(c.corners[1]).add(c.corners[2]).take();
}

}  // namespace carousel::accel
