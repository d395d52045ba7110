#include "accel/exact/exact_sphere.h"

#include "accel/exact/exact_matrix.h"

namespace carousel::accel {

std::optional<ExactSphereCrossings> exact_sphere(const Ray& ray, const scene::Sphere& sphere, const scene::Affine& m) {
  const ExactAdjugate to_model(m);
  const Dyadic& determinant = to_model.determinant;
  if (determinant.sign() == 0) return std::nullopt;
  DyadicVec offset, direction;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    offset[axis] = Dyadic(ray.origin[a]) - Dyadic(m.translation[a]);
    direction[axis] = Dyadic(ray.direction[a]);
  }
  ExactSphereCrossings out;
  for (std::size_t row = 0; row < 3; ++row) {
    out.from[row] = dot(to_model.rows[row], offset) - determinant * Dyadic(sphere.center[static_cast<int>(row)]);
    out.along[row] = dot(to_model.rows[row], direction);
  }
  out.radius = determinant * Dyadic(sphere.radius);
  // |from + t along|^2 = radius^2
  const Dyadic a = dot(out.along, out.along), b = dot(out.from, out.along);
  const Dyadic c = dot(out.from, out.from) - out.radius * out.radius;
  const Dyadic discriminant = b * b - a * c;
  if (a.sign() == 0 || discriminant.sign() < 0) return std::nullopt;
  out.t = {ExactRoot{-b, a, -1, discriminant}, ExactRoot{-b, a, 1, discriminant}};
  return out;
}

DVec3 ExactSphereCrossings::normal(std::size_t k) const {
  constexpr unsigned kBits = 256;  // far more than a position loses to cancellation
  const Dyadic numerator = t[k].numerator(kBits), &whole = t[k].denominator, size = whole * radius;
  DVec3 out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out[static_cast<int>(axis)] = rounded_ratio<double>(from[axis] * whole + numerator * along[axis], size);
  return out;
}

}  // namespace carousel::accel
