#pragma once

#include "core/types/vec.h"
#include "shading/bsdf/bsdf.h"
#include "shading/bsdf/glass_albedo.h"

namespace carousel::shading {

/// A material's boundary at one point: what glTF's ior, specular, iridescence, anisotropy and transmission make of
/// metallic-roughness.
struct InterfacePoint {
  MaterialPoint material;
  Vec2 alpha{1, 1};  ///< GGX along local x and y
  Vec3 dielectric_f0{0.04f};
  float dielectric_f90 = 1;
  Vec3 metal_f0{1};
  float transmission = 0;              ///< share of the light below the boundary that goes through, not into the base
  float eta = 1;                       ///< index of refraction below over above; without `glass` it does not refract
  const GlassAlbedo* glass = nullptr;  ///< of `eta`; null: opaque, or a thin wall
};

/// As Bsdf, with a Fresnel factor of any colour and with light going through (wi.z < 0): by refraction if the point has
/// `glass`, straight on if not. What single scattering loses comes back cosine-like on both sides, so that nothing is
/// lost or made. Reciprocal, thin walls included; with `glass` or with two roughnesses only in what single scattering
/// does, since the rest then depends on wo alone.
template <bool kTransmits>
class InterfaceBsdf {
 public:
  InterfaceBsdf(const InterfacePoint& point, const Vec3& wo);

  BsdfValue evaluate(const Vec3& wi) const;
  /// May come out with wi.z 0, then it carries nothing.
  Vec3 sample(float lobe, const Vec2& u) const;
  bool is_wide(float lobe) const;

 private:
  /// Colours of what one microfacet does; `cosine` is that of wo and its normal.
  struct Facet {
    Vec3 reflected{0}, through{0};
    float reflected_share = 1;  ///< probability of sampling reflection
    float cosine = 0;           ///< refracted, if any
  };
  Facet facet(float cosine) const;
  void opaque_lobes();
  void glass_lobes();
  /// From the albedos of the lobe of single scattering, and of what is cosine-like above and below.
  void choose_shares(const Vec3& single, const Vec3& matte, const Vec3& matte_through);
  BsdfValue reflected(const Vec3& wi) const;
  BsdfValue through(const Vec3& wi) const;

  Vec3 wo_;
  InterfacePoint point_;
  bool anisotropic_;
  Vec3 tint_{0};              // of light through: transmission times the base colour of what is not metal
  Vec3 diffuse_{0};           // base / pi times what the view direction lets through
  Vec3 multiple_{0};          // of light reflected several times, likewise
  Vec3 multiple_through_{0};  // of light that goes through after several times
  Vec3 returned_{0};          // share of what single scattering loses that is reflected, without glass
  float interface_share_ = 1, above_share_ = 0, below_share_ = 0;  // probabilities; the latter cosine-like
};

extern template class InterfaceBsdf<false>;
extern template class InterfaceBsdf<true>;

}  // namespace carousel::shading
