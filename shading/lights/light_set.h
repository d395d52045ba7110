#pragma once

#include <cstdint>

#include "core/config/fields/accuracy.h"
#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"
#include "shading/lights/emissive_primitives.h"
#include "shading/lights/light_choice.h"
#include "shading/lights/sky_light.h"
#include "shading/math/sampler.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

/// One sampled light. `radiance` counts only if the shadow ray along `direction` finds no occluder.
struct LightSample {
  Vec3 direction{0};  ///< direction of the shadow ray, not normalised, from the point given to sample()
  float tmax = 0;     ///< just short of the light
  Vec3 wi{0};         ///< unit direction
  Vec3 radiance{0};   ///< arriving radiance (irradiance for punctual lights) over the density; 0: no light
  float pdf = 0;      ///< density per solid angle; 0 for lights that no other ray can hit
};

/// Everything that next-event estimation chooses from: punctual lights, emissive triangles and spheres, and the map of
/// the sky, in proportion to their flux. Immutable; any thread.
class LightSet {
 public:
  /// `punctual`, `primitives` and `sky` say which lights can be chosen.
  explicit LightSet(const scene::Scene& scene, bool punctual = true, bool primitives = true, bool sky = true);

  bool empty() const { return choice_.empty(); }
  std::uint32_t count() const { return empty() ? 0 : sky_index() + (has_sky() ? 1 : 0); }
  /// Precondition: !empty().
  LightSample sample(const LightDraw& draw, const Vec3& origin, SpawnOffset offset) const;

  /// Density per solid angle with which sample() finds the point of an emissive primitive that a ray of unit direction
  /// met, on its `front` or not, under |cosine| `cos_light`.
  float primitive_pdf(const Hit& hit, const TriangleGeometry& geometry, bool front, float cos_light) const;

  /// The sky has a map from which light comes.
  bool has_sky() const { return !sky_.empty(); }
  /// The map as a ray sees it that leaves the scene, and the density with which sample() finds this direction.
  /// Precondition: has_sky().
  SkyLight::Seen sky(const Vec3& direction) const;
  /// Appends what sky() reads of memory. Precondition: has_sky().
  void append_sky_reads(const Vec3& direction, std::vector<SkyRead>& out) const { sky_.append_reads(direction, out); }
  /// Appends what sample() reads of the sky; nothing if it draws another light.
  void append_sky_reads(const LightDraw& draw, std::vector<SkyRead>& out) const;

 private:
  LightSample sample_primitive(const EmissivePrimitive& light, float probability, const Vec2& u, const Vec3& origin,
                               SpawnOffset offset) const;
  LightSample sample_sky(float probability, const Vec2& u) const;
  std::uint32_t sky_index() const {
    return static_cast<std::uint32_t>(scene_.lights.size() + primitives_.all().size());
  }

  const scene::Scene& scene_;
  EmissivePrimitives primitives_;
  SkyLight sky_;
  LightChoice choice_;  // punctual lights first, then primitives, then the sky
};

}  // namespace carousel::shading
