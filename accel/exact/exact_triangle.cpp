// Signed volumes of the ray and the triangle's edges, first in double with an error bound, then, when the bound does
// not settle it, exactly: adaptive as in Shewchuk 1997, with two stages. Products of three differences of floats are
// multiples of 2^-447 below 2^391, so double neither overflows nor loses bits in either stage.
#include "accel/exact/exact_triangle.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "accel/exact/expansion.h"

namespace carousel::accel {

namespace {

/// A corner seen from the origin: nearest + rest, exactly.
struct Offset {
  double nearest[3], rest[3];

  Offset(const Vec3& corner, const Vec3& origin) {
    for (int axis = 0; axis < 3; ++axis) {
      const double a = corner[axis], b = origin[axis], difference = a - b, back = a - difference;
      nearest[axis] = difference;
      rest[axis] = (a - (difference + back)) + (back - b);  // Two-Diff, figure 5 of Shewchuk
    }
  }
};

/// A number known up to an error: |number - value| <= error.
struct Bounded {
  double value, error;

  bool sign_is_certain() const { return error == 0 || std::fabs(value) > error; }
};
int sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// Error bound of a volume in double, relative to the sum of the magnitudes of its terms: eight roundings (one a
/// factor, two products, a difference, two sums), with room for those of the sum itself.
constexpr double kVolumeError = 10 * 0x1p-53;

/// a . (b x c) for a vector `a` of doubles.
Bounded volume(const double* a, const double* b, const double* c) {
  double value = 0, magnitude = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double left = b[j] * c[k], right = b[k] * c[j];
    value += a[i] * (left - right);
    magnitude += std::fabs(a[i]) * (std::fabs(left) + std::fabs(right));
  }
  return {value, kVolumeError * magnitude};
}

/// Adds the exact a . (b x c) to `sum`, where `a` is the sum of `a` and `a_rest`; `a_rest` may be null.
void add_volume(const double* a, const double* a_rest, const Offset& b, const Offset& c, Expansion& sum) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    Expansion minor;
    for (const double x : {b.nearest[j], b.rest[j]})
      for (const double y : {c.nearest[k], c.rest[k]}) minor.add_product(x, y);
    for (const double x : {b.nearest[k], b.rest[k]})
      for (const double y : {c.nearest[j], c.rest[j]}) minor.add_product(-x, y);
    sum.add_product(minor, a[i]);
    if (a_rest != nullptr) sum.add_product(minor, a_rest[i]);
  }
}

/// The float nearest to all numbers within `error` of q, if it is the same for all of them.
bool only_nearest(double q, double error, float& out) {
  const float low = static_cast<float>(q - error), high = static_cast<float>(q + error);
  out = low + 0.0f;  // no -0
  return low == high;
}

bool nearest_quotient(const Bounded& n, const Bounded& d, float& out) {
  const double least = std::fabs(d.value) - d.error;
  if (!(least > 0)) return false;
  const double q = n.value / d.value, error = (n.error + std::fabs(q) * d.error) / least;
  return only_nearest(q, error * (1 + 0x1p-50) + std::fabs(q) * 0x1p-50, out);
}

/// The float nearest to n / d, whose sign `d` must have.
float nearest_quotient(const Expansion& n, const Expansion& d) {
  const double q = n.estimate() / d.estimate();
  float nearest;
  if (only_nearest(q, std::fabs(q) * 0x1p-48, nearest)) return nearest;
  // Between two neighbours: which side of their middle? Infinity is as far as one more binade would be.
  const float low = static_cast<float>(q - std::fabs(q) * 0x1p-48),
              high = static_cast<float>(q + std::fabs(q) * 0x1p-48);
  const double from = std::isinf(low) ? -0x1p128 : low, to = std::isinf(high) ? 0x1p128 : high;
  Expansion beyond = n;
  beyond.add_product(d, -(from + (to - from) / 2));
  const int side = beyond.sign() * d.sign();
  const bool low_is_even = (std::bit_cast<std::uint32_t>(low) & 1) == 0;
  return (side > 0 || (side == 0 && !low_is_even) ? high : low) + 0.0f;
}

thread_local std::uint64_t volumes = 0;

bool finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

bool exact_triangle(const Ray& ray, const std::array<Vec3, 3>& p, NearestCrossing& out) {
  if (!finite(ray.origin) || !finite(ray.direction) || !finite(p[0]) || !finite(p[1]) || !finite(p[2])) return false;
  const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const Offset corner[3] = {{p[0], ray.origin}, {p[1], ray.origin}, {p[2], ray.origin}};

  // side[k] is the ray against the edge that faces corner k, and that corner's weight times their sum.
  Bounded side[3];
  bool positive = false, negative = false;
  for (int k = 0; k < 3; ++k) {
    side[k] = volume(d, corner[(k + 2) % 3].nearest, corner[(k + 1) % 3].nearest);
    if (!side[k].sign_is_certain()) continue;
    positive |= side[k].value > 0;
    negative |= side[k].value < 0;
  }
  if (positive && negative) return false;

  Expansion exact[3];
  bool is_exact[3] = {};
  const auto settle = [&](int k) {
    if (is_exact[k]) return;
    is_exact[k] = true;
    ++volumes;
    add_volume(d, nullptr, corner[(k + 2) % 3], corner[(k + 1) % 3], exact[k]);
  };
  for (int k = 0; k < 3; ++k) {
    if (side[k].sign_is_certain()) continue;
    settle(k);
    const double value = exact[k].estimate();
    side[k] = {value, std::fabs(value) * 0x1p-51};
    positive |= sign(value) > 0;
    negative |= sign(value) < 0;
  }
  // Neither: all three are zero, and so is their sum, direction . normal.
  if (positive == negative) return false;

  // t = a . (c x b) / sum; the sides have one sign, so nothing cancels in the sum.
  const double sum = side[0].value + side[1].value + side[2].value;
  const Bounded whole{sum, (side[0].error + side[1].error + side[2].error) * (1 + 0x1p-50) + std::fabs(sum) * 0x1p-51};
  const Bounded depth = volume(corner[0].nearest, corner[2].nearest, corner[1].nearest);
  if (nearest_quotient(depth, whole, out.t) && nearest_quotient(side[1], whole, out.u) &&
      nearest_quotient(side[2], whole, out.v))
    return true;

  for (int k = 0; k < 3; ++k) settle(k);
  Expansion exact_sum = exact[0], exact_depth;
  exact_sum.add(exact[1]);
  exact_sum.add(exact[2]);
  ++volumes;
  add_volume(corner[0].nearest, corner[0].rest, corner[2], corner[1], exact_depth);
  out = {nearest_quotient(exact_depth, exact_sum), nearest_quotient(exact[1], exact_sum),
         nearest_quotient(exact[2], exact_sum)};
  return true;
}

std::uint64_t exact_volumes() {
  return volumes;
}

int exact_facing(const Vec3& direction, const std::array<Vec3, 3>& p) {
  if (!finite(direction) || !finite(p[0]) || !finite(p[1]) || !finite(p[2])) return 0;
  const double d[3] = {direction.x, direction.y, direction.z};
  const Offset b(p[1], p[0]), c(p[2], p[0]);
  if (const Bounded along = volume(d, b.nearest, c.nearest); along.sign_is_certain()) return -sign(along.value);
  Expansion exact;
  add_volume(d, nullptr, b, c, exact);
  return -exact.sign();
}

}  // namespace carousel::accel
