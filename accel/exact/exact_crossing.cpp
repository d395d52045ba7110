#include "accel/exact/exact_crossing.h"

namespace carousel::accel {

namespace {

DyadicVec exact(const Vec3& v) {
  return {Dyadic(v.x), Dyadic(v.y), Dyadic(v.z)};
}

DyadicVec cross(const DyadicVec& a, const DyadicVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

std::optional<ExactCrossing> exact_crossing(const Ray& ray, const std::array<Vec3, 3>& model, const scene::Affine& m) {
  const DyadicVec direction = exact(ray.direction);
  std::array<DyadicVec, 3> p;  // vertices seen from the origin
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t row = 0; row < 3; ++row) {
      const int r = static_cast<int>(row);
      Dyadic x = Dyadic(m.translation[r]) - Dyadic(ray.origin[r]);
      for (int c = 0; c < 3; ++c) x = x + Dyadic(m.linear[c][r]) * Dyadic(model[k][c]);
      p[k][row] = x;
    }
  }
  // d . (P1 x P2) and its like are the triangle's three parts as the ray sees them; their sum is d . n.
  ExactCrossing out;
  const DyadicVec n01 = cross(p[0], p[1]), n12 = cross(p[1], p[2]), n20 = cross(p[2], p[0]);
  out.weight = {dot(direction, n12), dot(direction, n20), dot(direction, n01)};
  out.denominator = out.weight[0] + out.weight[1] + out.weight[2];
  const int facing = out.denominator.sign();
  if (facing == 0) return std::nullopt;
  for (Dyadic& w : out.weight) {
    if (facing < 0) w = -w;
    if (w.sign() < 0) return std::nullopt;
  }
  out.front = facing < 0;
  out.numerator = dot(p[0], n12);
  if (facing < 0) {
    out.numerator = -out.numerator;
    out.denominator = -out.denominator;
  }
  return out;
}

}  // namespace carousel::accel
