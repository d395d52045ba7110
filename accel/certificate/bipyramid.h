#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "accel/certificate/kernel_answers.h"

namespace carousel::accel {

inline constexpr std::size_t kLeastRing = 3, kMostRing = 8;

/// Two pyramids on one base: closed as every edge belongs to two of the triangles.
inline std::vector<Corners> bipyramid(const Vec3& apex, const Vec3& nadir, std::span<const Vec3> ring) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 a = ring[i], b = ring[(i + 1) % ring.size()];
    triangles.push_back({apex, a, b});
    triangles.push_back({nadir, b, a});
  }
  return triangles;
}

/// Corners of a bipyramid of size 1: apex, nadir, then the ring, each moved by `world`.
template <class Random, class World>
std::vector<Vec3> bipyramid_corners(std::size_t sides, Random& random, const World& world) {
  std::vector<Vec3> corners{world(DVec3(0, 0, random.uniform(0.5f, 1))), world(DVec3(0, 0, -random.uniform(0.5f, 1)))};
  for (std::size_t i = 0; i < sides; ++i) {
    const double angle =
        2 * std::numbers::pi * (static_cast<double>(i) + random.uniform(-0.25f, 0.25f)) / static_cast<double>(sides);
    const double radius = random.uniform(0.7f, 1.4f);
    corners.push_back(world(DVec3(radius * std::cos(angle), radius * std::sin(angle), random.uniform(-0.2f, 0.2f))));
  }
  return corners;
}

struct EdgePoint {
  Vec3 at;
  std::uint32_t how;  ///< 0 to 3; 0: a corner, 1: the middle
};

/// A point of an edge: from an apex to the base, or along the base.
template <class Random>
EdgePoint edge_point(std::span<const Vec3> corners, Random& random) {
  const auto sides = static_cast<std::uint32_t>(corners.size() - 2);
  const std::uint32_t first = random.below(sides + 2), side = random.below(sides);
  const Vec3 a = corners[first], b = corners[2 + (first < 2 ? side : (first - 1) % sides)];
  const std::uint32_t how = random.below(4);
  return {how == 0 ? a : how == 1 ? 0.5f * (a + b) : a + random.uniform() * (b - a), how};
}

}  // namespace carousel::accel
