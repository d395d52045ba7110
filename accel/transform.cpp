#include "accel/transform.h"

#include <cmath>
#include <limits>

#include <glm/matrix.hpp>

namespace carousel::accel {

bool make_transform(const scene::Affine& m, InstanceTransform& out) {
  out = InstanceTransform{};
  out.translation = m.translation;
  out.identity = m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f);
  if (out.identity) return true;
  const DMat3 linear(m.linear);
  const double det = glm::determinant(linear);
  if (!std::isfinite(det) || det == 0.0) return false;
  const Mat3 inverse(glm::inverse(linear));
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!std::isfinite(inverse[c][r])) return false;
  out.inverse_linear = inverse;
  return true;
}

Aabb world_box(const scene::Affine& m, const Aabb& model) {
  if (model.empty()) return {};
  if (m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f)) return model;
  constexpr double kU = 0x1p-24, kGamma4 = 4 * kU / (1 - 4 * kU);
  Aabb box;
  for (int row = 0; row < 3; ++row) {
    double lo = m.translation[row], hi = lo, magnitude = std::fabs(lo);
    for (int c = 0; c < 3; ++c) {
      const double a = double(m.linear[c][row]) * model.lo[c], b = double(m.linear[c][row]) * model.hi[c];
      lo += std::fmin(a, b);
      hi += std::fmax(a, b);
      magnitude += std::fmax(std::fabs(a), std::fabs(b));
    }
    const double pad = kGamma4 * magnitude;
    box.lo[row] = std::nextafter(float(lo - pad), -std::numeric_limits<float>::infinity());
    box.hi[row] = std::nextafter(float(hi + pad), std::numeric_limits<float>::infinity());
  }
  return box;
}

}  // namespace carousel::accel
