#include "app/accuracy/sensible_levels.h"

#include <algorithm>

namespace carousel::app {

std::vector<AccuracyConfig> sensible_levels(const scene::Scene& scene, const AccuracyConfig& base) {
  std::vector<AccuracyConfig> out;
  const auto add = [&](TriangleLevel triangle, BoxLevel box, TransformLevel transform) {
    AccuracyConfig& c = out.emplace_back(base);
    c.triangle = triangle, c.box = box, c.transform = transform;
  };
  using T = TriangleLevel;
  using B = BoxLevel;
  using X = TransformLevel;
  const bool transforms =
      std::any_of(scene.instances.begin(), scene.instances.end(), [](const scene::Instance& instance) {
        const scene::Affine& m = instance.world_from_model;
        return m.linear != Mat3(1.0f) || m.translation != Vec3(0.0f);
      });
  if (transforms) add(T::kFast, B::kPlain, X::kInverseMatrix);
  for (const auto& [triangle, box] : {std::pair{T::kFast, B::kPlain},
                                      {T::kFast, B::kConservative},
                                      {T::kWatertight, B::kPlain},
                                      {T::kWatertight, B::kConservative},
                                      {T::kDouble, B::kConservative},
                                      {T::kDouble, B::kDouble},
                                      {T::kExact, B::kConservative},
                                      {T::kExact, B::kDouble}})
    add(triangle, box, X::kTwoStep);
  if (!transforms) return out;
  for (const X transform : {X::kInverseMatrix, X::kTransposeIfRotation, X::kTwoStepDouble})
    add(T::kWatertight, B::kConservative, transform);
  add(T::kExact, B::kDouble, X::kTwoStepDouble);
  return out;
}

}  // namespace carousel::app
