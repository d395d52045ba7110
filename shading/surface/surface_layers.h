#pragma once

#include "scene/model/scene.h"
#include "shading/bsdf/interface_bsdf.h"
#include "shading/bsdf/layered_bsdf.h"
#include "shading/math/shading_basis.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

/// Tables of a material that refracts, for light from outside and from inside; null for any other.
struct GlassTables {
  const GlassAlbedo* outside = nullptr;
  const GlassAlbedo* inside = nullptr;
};
GlassTables glass_tables(const scene::Material& material);

/// A hit as the layers' functions see it.
struct SurfaceHit {
  const scene::Scene& scene;
  const TrianglePoint& point;
  const TriangleGeometry& geometry;
  Vec3 facing;  ///< geometric normal on the viewer's side
  Vec3 wo;      ///< unit, world
  bool front;
  bool blurred;  ///< roughnesses are to be widened: widened_roughness()
};

/// The frame to shade in: that of the shading normal `n`, turned along the grain if the material has one.
ShadingBasis grain_frame(const SurfaceHit& hit, const Vec3& n);

/// `material` is the point's, already widened; `cosine` that of wo and the shading normal.
InterfacePoint interface_point(const SurfaceHit& hit, const MaterialPoint& material, const GlassTables& glass,
                               float cosine);

/// Clearcoat and sheen; both lie on the outside, so a refracting volume has none when seen from inside.
LayerPoint layer_point(const SurfaceHit& hit, const ShadingBasis& frame, const GlassTables& glass);

}  // namespace carousel::shading
