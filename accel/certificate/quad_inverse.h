#pragma once

#include <array>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "scene/model/scene.h"

namespace carousel::accel {

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
  /// The sum of the magnitudes of the terms of point(), which a relative error bound multiplies.
  Vec terms(const Vec3& p) const { return sum(p, true); }

  static double norm(const Vec& v) { return static_cast<double>(Quad(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]))); }
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
