#include "scene/model/quantise.h"

#include <algorithm>
#include <cmath>

namespace carousel::scene {

namespace {

constexpr int kFloatBits = 24, kLeastExponent = -149;

/// The least power of two that is not less than `length`, which is above 0.
int power_above(double length) {
  int exponent = 0;
  const double fraction = std::frexp(length, &exponent);
  return fraction == 0.5 ? exponent - 1 : exponent;
}

void quantise(Mesh& mesh, int bits) {
  if (mesh.positions.empty()) return;
  double longest = 0, farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto less = [&](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(mesh.positions.begin(), mesh.positions.end(), less);
    const double lo = (*low)[axis], hi = (*high)[axis];
    longest = std::max(longest, hi - lo);
    farthest = std::max({farthest, std::abs(lo), std::abs(hi)});
  }
  if (longest == 0) return;
  const int exponent = std::max({power_above(longest) - bits, power_above(farthest) - kFloatBits, kLeastExponent});
  const double step = std::ldexp(1.0, exponent);
  for (Vec3& position : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = std::round(static_cast<double>(position[axis]) / step);
      position[axis] = static_cast<float>((steps == 0 ? 0 : steps) * step);  // one zero, without a sign
    }
}

}  // namespace

void quantise(Scene& scene, int bits) {
  for (Mesh& mesh : scene.meshes) quantise(mesh, bits);
}

}  // namespace carousel::scene
