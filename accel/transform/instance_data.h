#pragma once

#include <cstdint>

#include "core/config/fields/accuracy.h"
#include "core/costs/operations.h"

namespace carousel::accel {

/// Bytes that hardware built after the configuration stores of each instance's transform. The program itself always
/// keeps the data that its kernels need; nothing here changes a hit.
inline AccuracyConfig::InstanceData stored_instance_data(const AccuracyConfig& c) {
  using Data = AccuracyConfig::InstanceData;
  if (c.instance_data) return *c.instance_data;
  if (c.invert == AccuracyConfig::Invert::kVisit) return Data::kForward;
  return c.transform == TransformLevel::kInverseMatrix ? Data::kInverse : Data::kRt;
}

/// Its bytes: twelve floats of 3 x 4 entries; nine of them in fp64 where the inverse is stored and used in fp64.
inline std::uint32_t instance_bytes(const AccuracyConfig& c) {
  const bool fp64 =
      c.transform == TransformLevel::kTwoStepDouble && stored_instance_data(c) == AccuracyConfig::InstanceData::kRt;
  return fp64 ? 9 * 8 + 3 * 4 : 12 * 4;
}

/// The stored data of an instance whose rays are transformed in fp64 because its matrix is nearly singular.
inline std::uint32_t promoted_bytes(AccuracyConfig c) {
  c.transform = TransformLevel::kTwoStepDouble;
  return instance_bytes(c);
}

/// Bytes of a ray in model space, which `transformed_ray: store` keeps beside the record: origin and direction.
inline constexpr std::uint32_t kTransformedRayBytes = 6 * 4;

/// Transforms whose time an inversion takes in the transform unit. A transform is R^-1 times an origin and a direction;
/// R^-1 by cofactors is 18 products for the nine, 3 for the determinant and 9 to scale them, with one reciprocal: two
/// passes through the same multipliers. The inverse of the whole matrix, which `inverse_matrix` needs, has R^-1 T
/// besides, 9 more: three passes (US 12394134, paragraph 25: the two steps need no full inverse).
inline constexpr std::uint64_t kInversionPasses = passes_through(Method::kTwoStep, Method::kInversion),
                               kFullInversionPasses = passes_through(Method::kTwoStep, Method::kFullInversion);

}  // namespace carousel::accel
