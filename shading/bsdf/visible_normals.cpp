#include "shading/bsdf/visible_normals.h"

#include <array>
#include <cstddef>

namespace carousel::shading {

namespace {

/// The lattice of two successive Fibonacci numbers.
template <std::size_t kPoints, std::size_t kBefore>
std::array<LatticePoint, kPoints> fibonacci_lattice() {
  std::array<LatticePoint, kPoints> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const SinCos azimuth = sin_cos_turns(float(i * kBefore % kPoints) / kPoints);
    const float x = 1.0f - (float(i) + 0.5f) / kPoints;
    points[i] = {azimuth.cos, azimuth.sin, x * x, 2.0f * x / kPoints};
  }
  return points;
}

}  // namespace

std::span<const LatticePoint> coarse_lattice() {
  static const auto lattice = fibonacci_lattice<144, 89>();
  return lattice;
}

std::span<const LatticePoint> fine_lattice() {
  static const auto lattice = fibonacci_lattice<610, 377>();
  return lattice;
}

}  // namespace carousel::shading
