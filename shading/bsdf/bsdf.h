#pragma once

#include "core/types/vec.h"

namespace carousel::shading {

/// A material at one point, with textures and vertex colours applied. Colours are linear.
struct MaterialPoint {
  Vec3 base_color{1};
  float metallic = 0, roughness = 1;
};

/// The roughness of a surface that is seen by way of a wide lobe: at least 0.55. A narrow lobe there would focus light
/// onto rare paths (caustics), which show as bright specks. The lobe is blurred where it is not seen directly: the
/// "regularisation" of M. Pharr, W. Jakob, G. Humphreys, "Physically based rendering", 4th edition, section 14.5.
float widened_roughness(float roughness);

/// f * cos of the incoming direction, and the density with which sample() chooses that direction.
struct BsdfValue {
  Vec3 f_cos{0};
  float pdf = 0;
};

/// glTF's metallic-roughness surface seen from one direction: a GGX lobe over a diffuse base. Local
/// coordinates, z is the shading normal on the viewer's side; directions are unit and point away. The function is
/// reciprocal, and conserves energy except for the base colour: light that the single-scattering lobe loses between
/// microfacets returns as a diffuse-like lobe (Kulla, Conty 2017), and the base receives the light that the dielectric
/// coat transmits (C. Kelemen, L. Szirmay-Kalos, "A microfacet based coupled specular-matte BRDF model",
/// Eurographics 2001).
class Bsdf {
 public:
  /// `wo` points to the viewer, wo.z > 0.
  Bsdf(const MaterialPoint& material, const Vec3& wo);

  /// Zero for wi.z <= 0.
  BsdfValue evaluate(const Vec3& wi) const;
  /// A direction with the density that evaluate() reports. If its z is <= 0, it carries no light.
  Vec3 sample(float lobe, const Vec2& u) const;
  /// True if sample() with this `lobe` spreads too widely to show an image in it.
  bool is_wide(float lobe) const;

 private:
  Vec3 wo_, f0_;
  Vec3 diffuse_;   // base albedo / pi, times the share transmitted for the view direction
  Vec3 multiple_;  // the lobe of light reflected several times, likewise
  float alpha_;
  float specular_share_;  // probability of sampling the GGX lobe
};

}  // namespace carousel::shading
