// A point that the kernel reports lies beside the ray's line. accel/planes/cull_plane_clip.h derives the distance in
// the space of the kernel's ray: e <= 6 u g' along any axis, g' the largest distance along an axis from its origin to a
// vertex.
//
// Seen from the world that ray is rounded. With R, T the instance's matrix and translation, M the inverse that is used,
// o and d the ray's origin and direction, o' = M (o - T) + eo and d' = M d + ed, the triangle's point p = o' + t* d' +
// e stands in the world at P = R p + T. This is exact, since the program does not compute it, and
//
//   P - o - t* d = (R M - I)(o - T + t* d) + R (eo + t* ed + e).
//
// A float difference, product and two sums make |eo| <= gamma(4) |M||o - T| and |ed| <= gamma(3) |M||d|; in double all
// is exact to 2^-50 but for one rounding to float. The error of the inverse (its own rounding, or that of a transpose)
// stands in R M - I, which is computed here. With g the reach in the world, h >= |R p| and a vertex's size s >= |p|:
// |t* d| <= g + the bound sought, |o - T| <= g + h, and g' <= |M| g + |M R - I| s + |eo|. Collected, P lies within
// a g + b of the line along any axis: a in distances along an axis, as for the kernel, and b in lengths, which does not
// depend on T.
#include "accel/planes/line_margin.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "accel/planes/cull_plane_clip.h"
#include "accel/planes/plane_candidates.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

/// Covers the plane test's own rounding, and makes a margin larger than the derived one.
constexpr double kTestRounding = 13 * kUnitRoundoff, kReserve = 32.0 / 19;
constexpr double kKernelRounding = 6 * kUnitRoundoff;
/// The second-order terms of the derivation, relative to the first-order ones, for a at most kMost.
constexpr double kSecondOrder = 1.01, kMost = 0x1p-8;
/// No margin is known for larger rows of R and M. Up to this size, CullRay takes a ray's direction below if it takes it
/// in the world.
constexpr double kLargest = 0x1p30;

double largest(const DVec3& v) {
  return std::max({v.x, v.y, v.z});
}

/// The margin for a and b of the derivation above, with the rounding of the test and a reserve.
LineMargin margin(double a, double b, double least) {
  return {rounded_up(kReserve * (kTestRounding + a)), rounded_up(kReserve * b + least)};
}

/// |product - I| plus the rounding error of the product in double.
DMat3 rest_of(const DMat3& a, const DMat3& b) {
  return magnitudes(a * b - DMat3(1)) + 0x1p-50 * (magnitudes(a) * magnitudes(b));
}

}  // namespace

DMat3 magnitudes(const DMat3& m) {
  return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

LineMargin margin_below() {
  return {kMarginPerReach, kLeastMargin};
}

std::optional<LineMargin> margin_in_world(const scene::Affine& world_from_model, const InstanceTransform& transform,
                                          const Aabb& model) {
  if (transform.identity) return margin_below();
  const bool in_double = transform.form == InstanceTransform::Form::kTwoStepDouble;
  const DMat3 r(world_from_model.linear), m = DMat3(transform.inverse_linear) + DMat3(transform.inverse_rest);
  const DMat3 abs_r = magnitudes(r), abs_m = magnitudes(m), world_rest = rest_of(r, m), model_rest = rest_of(m, r);
  const DVec3 ones(1), size = glm::max(glm::abs(DVec3(model.lo)), glm::abs(DVec3(model.hi))), h = abs_r * size;
  const double origin = in_double ? gamma(1) : gamma(4), direction = in_double ? gamma(1) : gamma(3);
  const double m_rows = largest(abs_m * ones), r_rows = largest(abs_r * ones);
  const double a =
      kSecondOrder * largest(abs_r * ((origin + direction) * (abs_m * ones) + kKernelRounding * m_rows * ones) +
                             2.0 * (world_rest * ones));
  const double beside = largest(model_rest * size + origin * (abs_m * h));
  const double b =
      kSecondOrder * largest(abs_r * (origin * (abs_m * h) + kKernelRounding * beside * ones) + world_rest * h);
  // Negated comparisons also turn NaN away.
  if (!(a <= kMost && m_rows <= kLargest && r_rows <= kLargest && std::isfinite(b))) return std::nullopt;
  return margin(a, b, kLeastMargin * std::max(1.0, r_rows));
}

}  // namespace carousel::accel
