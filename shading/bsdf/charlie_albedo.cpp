#include "shading/bsdf/charlie_albedo.h"

#include <algorithm>
#include <cmath>

#include "shading/bsdf/charlie.h"

namespace carousel::shading {

namespace {

/// Midpoint rule over one half of the hemisphere; the other half is its mirror image. Cosines are squared, since the
/// lobe is strongest at the horizon.
float integrate(float cos_theta, float alpha) {
  constexpr int kPolar = 48, kAround = 24;
  const Vec3 wo{std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta)), 0.0f, cos_theta};
  float sum = 0;
  for (int i = 0; i < kPolar; ++i) {
    const float x = (float(i) + 0.5f) / kPolar;
    const float z = x * x, sine = std::sqrt(1.0f - z * z);
    for (int j = 0; j < kAround; ++j) {
      const SinCos phi = sin_cos_turns((float(j) + 0.5f) / (2 * kAround));
      sum += charlie_f_cos(wo, {sine * phi.cos, sine * phi.sin, z}, alpha) * 2.0f * x;
    }
  }
  return std::min(sum * (2.0f * kPi / (kPolar * kAround)), 1.0f);
}

}  // namespace

CharlieAlbedo::CharlieAlbedo() {
  for (int r = 0; r < kSize; ++r) {
    const float roughness = kMinSheenRoughness + (1.0f - kMinSheenRoughness) * float(r) / (kSize - 1);
    for (int c = 0; c < kSize; ++c) {
      const float x = std::max(float(c) / (kSize - 1), 0.05f);
      cells_[r][c] = integrate(x * x, charlie_alpha(roughness));
    }
  }
}

const CharlieAlbedo& CharlieAlbedo::table() {
  static const CharlieAlbedo albedo;
  return albedo;
}

float CharlieAlbedo::directional(float cos_theta, float alpha) const {
  const float x = std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)) * (kSize - 1);
  const float y =
      (std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) - kMinSheenRoughness) / (1.0f - kMinSheenRoughness) * (kSize - 1);
  const int c = std::min(int(x), kSize - 2), r = std::clamp(int(y), 0, kSize - 2);
  const float s = x - float(c), t = std::max(y - float(r), 0.0f);
  const float low = cells_[r][c] + s * (cells_[r][c + 1] - cells_[r][c]);
  const float high = cells_[r + 1][c] + s * (cells_[r + 1][c + 1] - cells_[r + 1][c]);
  return low + t * (high - low);
}

}  // namespace carousel::shading
