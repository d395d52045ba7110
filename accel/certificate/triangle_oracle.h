#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

#include "accel/certificate/big_quotient.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// A ray and a triangle as big integers, times a power of two that they share: where the line meets the plane, and
/// on which side of the edges that point lies. Not the formulas of accel/exact/exact_triangle.cpp.
class TriangleOracle {
 public:
  using Int = boost::multiprecision::cpp_int;

  TriangleOracle(const Ray& ray, const std::array<Vec3, 3>& p) {
    int& least = least_;
    for (const Vec3* v : {&ray.origin, &ray.direction, &p[0], &p[1], &p[2]})
      for (int a = 0; a < 3; ++a) least = std::min(least, lowest_bit((*v)[a]));
    const auto vector = [&least](const Vec3& v) {
      return IVec{integer(v.x, least), integer(v.y, least), integer(v.z, least)};
    };
    const IVec corner = vector(p[0]), e1 = sub(vector(p[1]), corner), e2 = sub(vector(p[2]), corner);
    const IVec d = vector(ray.direction), to_corner = sub(corner, vector(ray.origin)), n = cross(e1, e2);
    depth_ = dot(n, to_corner);
    facing_ = dot(n, d);
    if (facing_ == 0) return;
    // From the first corner to the crossing, times `facing_`.
    IVec in_plane;
    for (std::size_t a = 0; a < 3; ++a) in_plane[a] = d[a] * depth_ - to_corner[a] * facing_;
    whole_ = dot(n, n) * facing_;
    second_ = dot(n, cross(in_plane, e2));
    third_ = dot(n, cross(e1, in_plane));
    const Int first = whole_ - second_ - third_;
    const int side = whole_.sign();
    hit_ = first.sign() * side >= 0 && second_.sign() * side >= 0 && third_.sign() * side >= 0;
  }

  bool hit() const { return hit_; }
  bool t_is_nearest(float t) const { return is_nearest(t, depth_, facing_); }
  bool u_is_nearest(float u) const { return is_nearest(u, second_, whole_); }
  bool v_is_nearest(float v) const { return is_nearest(v, third_, whole_); }
  /// The distance of the plane, rounded; infinite if the ray does not cross it.
  double t() const { return facing_ == 0 ? kInfinity : big_quotient(depth_, facing_); }
  double u() const { return whole_ == 0 ? kInfinity : big_quotient(second_, whole_); }
  double v() const { return whole_ == 0 ? kInfinity : big_quotient(third_, whole_); }
  /// Direction times the cross product of the edges, rounded: how much of its area the triangle shows.
  double facing() const { return std::ldexp(facing_.convert_to<double>(), 3 * least_); }
  /// Sign of the exact t - x.
  int compare_t(float x) const { return Int((depth_ << 200) - integer(x, -200) * facing_).sign() * facing_.sign(); }

 private:
  using IVec = std::array<Int, 3>;

  static int lowest_bit(float x) {
    if (x == 0) return 1000;
    int exponent;
    const auto bits = static_cast<std::uint32_t>(std::ldexp(std::fabs(std::frexp(x, &exponent)), 24));
    return exponent - 24 + std::countr_zero(bits);
  }
  static Int integer(double x, int least) {  // x / 2^least, which is whole
    if (x == 0) return 0;
    int exponent;
    const double mantissa = std::frexp(x, &exponent);
    const auto bits = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    const int shift = exponent - 53 - least;
    return shift >= 0 ? Int(Int(bits) << shift) : Int(Int(bits) / (Int(1) << -shift));
  }
  static IVec sub(const IVec& a, const IVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static IVec cross(const IVec& a, const IVec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Int dot(const IVec& a, const IVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  /// True if x is the float nearest to n / d; of two equally near floats, the even one.
  static bool is_nearest(float x, Int n, Int d) {
    if (d < 0) n = -n, d = -d;
    const double kBeyond = 0x1p128;  // where infinity stands when it comes to rounding
    const auto value = [&](float f) { return std::isinf(f) ? std::copysign(kBeyond, double{f}) : double{f}; };
    const double here = value(x);
    n <<= 151;
    const bool even = (std::bit_cast<std::uint32_t>(x) & 1) == 0;
    if (x != kInfinity) {
      const Int up = integer((here + value(std::nextafter(x, kInfinity))) / 2, -151) * d;
      if (!(n < up || (even && n == up))) return false;
    }
    if (x != -kInfinity) {
      const Int down = integer((here + value(std::nextafter(x, -kInfinity))) / 2, -151) * d;
      if (!(n > down || (even && n == down))) return false;
    }
    return true;
  }

  Int depth_, facing_, whole_, second_, third_;
  int least_ = 1000;  // everything is a multiple of 2 to this power
  bool hit_ = false;
};

}  // namespace carousel::accel
