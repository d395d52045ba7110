#include "shading/surface/pane.h"

#include <algorithm>
#include <cmath>

#include "shading/bsdf/interface_bsdf.h"
#include "shading/math/luminance.h"
#include "shading/surface/material_properties.h"

namespace carousel::shading {

bool is_pane(const scene::Material& m) {
  return !m.unlit && transmits(m) && !has_volume(m) && m.roughness <= kMirrorRoughness && !(m.clearcoat.weight > 0) &&
         !(max_component(m.sheen.color) > 0) && !(m.anisotropy.strength > 0);
}

Vec3 passing_share(const InterfacePoint& pane, float cosine) {
  const Vec3 tint = pane.material.base_color * ((1.0f - pane.material.metallic) * pane.transmission);
  return tint * (Vec3{1} - boundary_albedo(pane, std::abs(cosine), pane.alpha.y));
}

float passing_chance(const InterfacePoint& pane, const Vec3& passing, float cosine) {
  const float through = luminance(passing), dielectric = 1.0f - pane.material.metallic;
  const float back = pane.material.metallic +
                     dielectric * luminance(boundary_albedo(pane, std::abs(cosine), pane.alpha.y)) +
                     dielectric * (1.0f - pane.transmission) * luminance(pane.material.base_color);
  if (!(through > 0.0f)) return 0.0f;
  return back > 0.0f ? std::min(through / (through + back), 0.98f) : 1.0f;
}

}  // namespace carousel::shading
