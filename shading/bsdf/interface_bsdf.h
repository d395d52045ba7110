#pragma once

#include "core/types/vec.h"
#include "shading/bsdf/bsdf.h"
#include "shading/bsdf/glass_albedo.h"

namespace carousel::shading {

/// A material's boundary at one point: metallic-roughness, changed by glTF's ior, specular, iridescence, anisotropy and
/// transmission.
struct InterfacePoint {
  MaterialPoint material;
  Vec2 alpha{1, 1};  ///< GGX along local x and y
  Vec3 dielectric_f0{0.04f};
  float dielectric_f90 = 1;
  Vec3 metal_f0{1};
  float transmission = 0;  ///< share of the light below the boundary that passes through instead of entering the base
  float eta = 1;           ///< index of refraction below over above; without `glass` it does not refract
  const GlassAlbedo* glass = nullptr;  ///< table for `eta`; null: opaque, or a thin wall
};

/// The share of light that a boundary without `glass` reflects, seen under a cosine `cosine` > 0, where its material is
/// not metal: once, or several times between its microfacets. `alpha`: of both directions.
Vec3 boundary_albedo(const InterfacePoint& point, float cosine, float alpha);

/// As Bsdf, with a Fresnel factor of any colour and with light that passes through (wi.z < 0): by refraction if the
/// point has `glass`, straight on if not. Energy that single scattering loses is returned by a cosine-like lobe on both
/// sides, so that energy is neither lost nor created. The function is reciprocal, thin walls included; with `glass` or
/// with two roughnesses only its single-scattering part is, since the rest then depends on wo alone.
template <bool kTransmits>
class InterfaceBsdf {
 public:
  InterfaceBsdf(const InterfacePoint& point, const Vec3& wo);

  BsdfValue evaluate(const Vec3& wi) const;
  /// The result may have wi.z = 0 and then carries no light.
  Vec3 sample(float lobe, const Vec2& u) const;
  bool is_wide(float lobe) const;

 private:
  /// Reflection and refraction of one microfacet; `cosine` is the one between wo and its normal.
  struct Facet {
    Vec3 reflected{0}, through{0};
    float reflected_share = 1;  ///< probability of sampling reflection
    float cosine = 0;           ///< cosine of the refracted direction, if there is one
  };
  Facet facet(float cosine) const;
  void opaque_lobes();
  void glass_lobes();
  /// The albedos are those of the single-scattering lobe and of the cosine-like lobes above and below.
  void choose_shares(const Vec3& single, const Vec3& matte, const Vec3& matte_through);
  BsdfValue reflected(const Vec3& wi) const;
  BsdfValue through(const Vec3& wi) const;

  Vec3 wo_;
  InterfacePoint point_;
  bool anisotropic_;
  Vec3 tint_{0};              // tint of transmitted light: transmission times the base colour of the dielectric part
  Vec3 diffuse_{0};           // base / pi times the share transmitted for the view direction
  Vec3 multiple_{0};          // value of light reflected several times, over pi
  Vec3 multiple_through_{0};  // value of light transmitted after several reflections, over pi
  Vec3 returned_{0};          // reflected share of the light that single scattering loses, without glass
  float interface_share_ = 1, above_share_ = 0, below_share_ = 0;  // probabilities; the latter cosine-like
};

extern template class InterfaceBsdf<false>;
extern template class InterfaceBsdf<true>;

}  // namespace carousel::shading
