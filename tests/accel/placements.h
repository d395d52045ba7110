#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "scene/scene.h"
#include "tests/accel/test_rays.h"

namespace carousel::accel {

/// Rotation about an axis of any length: Rodrigues' formula.
inline DMat3 rotation(const DVec3& axis, double degrees) {
  const DVec3 a = glm::normalize(axis);
  const double angle = degrees * std::numbers::pi / 180, s = std::sin(angle), c = std::cos(angle);
  const DMat3 cross({0, a.z, -a.y}, {-a.z, 0, a.x}, {a.y, -a.x, 0});
  return c * DMat3(1.0) + s * cross + (1 - c) * glm::outerProduct(a, a);
}

/// M = T S Rot in double, rounded once: rotate, then scale, then translate.
inline scene::Affine rotate_scale_translate(const DVec3& axis, double degrees, const DVec3& scale, const DVec3& t) {
  return {Mat3(DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * rotation(axis, degrees)), Vec3(t)};
}

/// The three examples of US 12394134.
inline std::array<scene::Affine, 3> patent_placements() {
  return {rotate_scale_translate({-0.484658, 0.310767, -0.817637}, 166, {5.062899, 1.343523, 1.331195},
                                 {-6139.630859, -918.470093, 49161.503906}),
          rotate_scale_translate({0.506287, 0.219681, 0.833915}, 328, {-1.337073, -0.625314, 1.900729},
                                 {2.952133, 1.276896, -44.617302}),
          rotate_scale_translate({-0.490687, 0.033258, -0.870701}, 243, {4.662860, 0.188493, 0.213617},
                                 {-12816.281250, 16287.140625, -115868.531250})};
}

inline DVec3 random_direction(Random& random) {
  for (;;) {
    const DVec3 v(random.in_box(Vec3{-1}, Vec3{1}));
    if (const double length = glm::length(v); length > 0.1 && length < 1) return v / length;
  }
}

inline double log_uniform(Random& random, double lo, double hi) { return lo * std::pow(hi / lo, random.uniform()); }

/// R^-1 (p - T) of the floats as they are, with 113 bits.
class QuadInverse {
 public:
  using Quad = boost::multiprecision::cpp_bin_float_quad;
  using Vec = std::array<Quad, 3>;

  explicit QuadInverse(const scene::Affine& m) : m_(m) {
    const auto at = [&](int row, int column) { return Quad(m.linear[column % 3][row % 3]); };
    Quad cofactor[3][3];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        cofactor[r][c] = at(r + 1, c + 1) * at(r + 2, c + 2) - at(r + 1, c + 2) * at(r + 2, c + 1);
    const Quad det = at(0, 0) * cofactor[0][0] + at(0, 1) * cofactor[0][1] + at(0, 2) * cofactor[0][2];
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) inverse_[r][c] = cofactor[c][r] / det;
  }

  Vec point(const Vec3& p) const { return sum(p, false); }
  /// The same with every term positive: what a relative error bound multiplies.
  Vec terms(const Vec3& p) const { return sum(p, true); }

  static double norm(const Vec& v) {
    return static_cast<double>(Quad(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])));
  }
  static double distance(const Vec3& a, const Vec& b) { return norm({a.x - b[0], a.y - b[1], a.z - b[2]}); }

 private:
  Vec sum(const Vec3& p, bool magnitudes) const {
    Vec out;
    for (std::size_t r = 0; r < 3; ++r) {
      out[r] = 0;
      for (int c = 0; c < 3; ++c) {
        const Quad term = inverse_[r][static_cast<std::size_t>(c)] * (Quad(p[c]) - m_.translation[c]);
        out[r] += magnitudes ? Quad(abs(term)) : term;
      }
    }
    return out;
  }

  scene::Affine m_;
  std::array<std::array<Quad, 3>, 3> inverse_;
};

}  // namespace carousel::accel
