#pragma once

#include <cstdint>

#include "core/types/any_hit.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// The any-hit call for the non-opaque surfaces of a scene. An alpha-masked surface stops rays where its alpha (the
/// product of the base colour's factor, texture and vertices) is at least its cutoff. An alpha-blended surface stops a
/// ray with probability alpha, so that a pixel's samples blend on average, in any order of the surfaces: E. Enderton,
/// E. Sintorn, P. Shirley, D. Luebke, "Stochastic transparency", I3D 2010. All other surfaces stop rays.
class AlphaTest final : public AnyHit {
 public:
  /// Keeps a reference to `scene`, which must not change meanwhile. Any thread may call accepts().
  explicit AlphaTest(const scene::Scene& scene) : scene_(scene) {}

  bool accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const override;

 private:
  const scene::Scene& scene_;
};

/// Random number in [0, 1) of one ray at one triangle: a hash of the bits of its origin and direction.
float blend_chance(const Ray& ray, std::uint32_t instance, std::uint32_t primitive);

}  // namespace carousel::shading
