#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <glm/geometric.hpp>

#include "core/types/ray.h"

namespace carousel::accel {

// Numbers that rounding treats badly. `Random` is CaseRandom or anything else with below(), uniform(), in_box() and
// any_bits().

/// `x` moved by up to `most` ulps.
template <class Random>
float nudged(float x, int most, Random& random) {
  const int steps = static_cast<int>(random.below(static_cast<std::uint32_t>(2 * most + 1))) - most;
  for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, steps < 0 ? -kInfinity : kInfinity);
  return x;
}
template <class Random>
Vec3 nudged(const Vec3& p, int most, Random& random) {
  return {nudged(p.x, most, random), nudged(p.y, most, random), nudged(p.z, most, random)};
}

/// A finite float of any exponent.
template <class Random>
float wild(Random& random) {
  for (;;)
    if (const float x = random.any_bits(); std::isfinite(x)) return x;
}

template <class Random>
Vec3 grid_point(Random& random, int reach) {
  const auto whole = [&] {
    return static_cast<float>(static_cast<int>(random.below(static_cast<std::uint32_t>(2 * reach + 1))) - reach);
  };
  return {whole(), whole(), whole()};
}

/// A power of two with an exponent in [least, most).
template <class Random>
float wild_power(Random& random, int least, int most) {
  return std::ldexp(1.0f, least + static_cast<int>(random.below(static_cast<std::uint32_t>(most - least))));
}

template <class Random>
DVec3 random_direction(Random& random) {
  for (;;) {
    const DVec3 v(random.in_box(Vec3{-1}, Vec3{1}));
    if (const double length = glm::length(v); length > 0.1 && length < 1) return v / length;
  }
}

template <class Random>
double log_uniform(Random& random, double lo, double hi) {
  return lo * std::pow(hi / lo, random.uniform());
}

}  // namespace carousel::accel
