#include "shading/bsdf/interface_bsdf.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/ggx.h"
#include "shading/bsdf/ggx_albedo.h"
#include "shading/bsdf/ggx_anisotropic.h"
#include "shading/bsdf/refraction_lobe.h"
#include "shading/bsdf/visible_normals.h"
#include "shading/math/luminance.h"

namespace carousel::shading {

namespace {

constexpr Vec3 kNowhere{1, 0, 0};  // along the surface, so that it carries no light

/// The share of light lost between microfacets that further microfacets return: C. Kulla, A. Conty, 2017.
Vec3 returned_share(const Vec3& f0, float f90, float average) {
  const Vec3 fresnel = f0 + (Vec3{f90} - f0) * (1.0f / 21.0f);
  return fresnel * fresnel * average / (Vec3{1} - fresnel * (1.0f - average));
}

/// Albedo of the single-scattering lobe; GgxAlbedo's table has one roughness only.
GgxAlbedo::Split single_split(const Vec3& wo, const Vec2& alpha) {
  if (alpha.x == alpha.y) return GgxAlbedo::table().split(wo.z, alpha.x);
  const float lambda_o = ggx_lambda(wo, alpha);
  GgxAlbedo::Split sum;
  visit_visible_normals(coarse_lattice(), wo, alpha, [&](const Vec3& h, float share) {
    const float oh = glm::dot(wo, h);
    const Vec3 wi = 2.0f * oh * h - wo;
    if (wi.z <= 0.0f) return;
    const float weight = share * (1.0f + lambda_o) / (1.0f + lambda_o + ggx_lambda(wi, alpha));
    sum.full += weight;
    sum.schlick += weight * schlick_weight(oh);
  });
  return sum;
}

Vec3 single_albedo(const Vec3& f0, float f90, const GgxAlbedo::Split& split) {
  return f0 * (split.full - split.schlick) + Vec3{f90 * split.schlick};
}

}  // namespace

Vec3 boundary_albedo(const InterfacePoint& point, float cosine, float alpha) {
  const GgxAlbedo& table = GgxAlbedo::table();
  const GgxAlbedo::Split view = table.split(cosine, alpha), mean = table.average_split(alpha);
  return single_albedo(point.dielectric_f0, point.dielectric_f90, view) +
         returned_share(point.dielectric_f0, point.dielectric_f90, mean.full) * (1.0f - view.full);
}

template <bool kTransmits>
InterfaceBsdf<kTransmits>::InterfaceBsdf(const InterfacePoint& point, const Vec3& wo)
    : wo_(wo), point_(point), anisotropic_(point.alpha.x != point.alpha.y) {
  if (kTransmits && point_.glass != nullptr)
    glass_lobes();
  else
    opaque_lobes();
}

/// Evaluates everything but refraction, thin walls included: the lobes are those of Bsdf with another Fresnel factor.
template <bool kTransmits>
void InterfaceBsdf<kTransmits>::opaque_lobes() {
  const MaterialPoint& m = point_.material;
  const float dielectric = 1.0f - m.metallic;
  const Vec3& f0 = point_.dielectric_f0;
  const float f90 = point_.dielectric_f90;
  const float alpha = std::sqrt(point_.alpha.x * point_.alpha.y);
  const GgxAlbedo::Split view = single_split(wo_, point_.alpha), mean = GgxAlbedo::table().average_split(alpha);

  returned_ = returned_share(f0, f90, mean.full);
  const float lost = anisotropic_ ? 1.0f - view.full : (1.0f - view.full) / std::max(1.0f - mean.full, kLeastShare);
  const Vec3 metal_returned = returned_share(point_.metal_f0, 1.0f, mean.full);
  multiple_ = (metal_returned * m.metallic + returned_ * dielectric) * (kInvPi * lost);

  const Vec3 coat = single_albedo(f0, f90, view) + returned_ * (1.0f - view.full);
  const Vec3 mean_coat = single_albedo(f0, f90, mean) + returned_ * (1.0f - mean.full);
  const Vec3 albedo = m.base_color * (dielectric * (1.0f - point_.transmission));
  diffuse_ = albedo * glm::max(Vec3{1} - coat, Vec3{0}) * kInvPi;
  if (!anisotropic_) diffuse_ /= glm::max(Vec3{1} - mean_coat, Vec3{kLeastShare});

  Vec3 single = single_albedo(point_.metal_f0, 1.0f, view) * m.metallic + single_albedo(f0, f90, view) * dielectric;
  const float view_lost = 1.0f - view.full;
  const Vec3 above = albedo * (Vec3{1} - coat) + (metal_returned * m.metallic + returned_ * dielectric) * view_lost;
  Vec3 below{0};
  if constexpr (kTransmits) {
    tint_ = m.base_color * (dielectric * point_.transmission);
    multiple_through_ = tint_ * (Vec3{1} - returned_) * (kInvPi * lost);
    single += tint_ * (Vec3{view.full} - single_albedo(f0, f90, view));
    below = tint_ * (Vec3{1} - returned_) * view_lost;
  }
  choose_shares(single, above, below);
}

template <bool kTransmits>
void InterfaceBsdf<kTransmits>::glass_lobes() {
  const MaterialPoint& m = point_.material;
  const float dielectric = 1.0f - m.metallic;
  const Vec3& f0 = point_.dielectric_f0;
  const float f90 = point_.dielectric_f90;
  // The base could receive all that the boundary does not reflect, but between the table's nodes at the critical angle
  // that would be wrong by a tenth.
  const bool table_will_do = !anisotropic_ && (point_.transmission == 1.0f || point_.eta > 1.0f);
  const GlassAlbedo::Shares s =
      table_will_do ? point_.glass->directional(wo_.z, point_.alpha.x) : glass_shares(wo_, point_.alpha, point_.eta);
  const Vec3 up = f0 * (s.reflected - s.reflected_w) + Vec3{f90 * s.reflected_w + s.total};
  const Vec3 down = Vec3{s.through} - f0 * (s.through - s.through_w) - Vec3{f90 * s.through_w};
  const Vec3 lost = glm::max(Vec3{1} - up - down, Vec3{0});
  const Vec3 lost_up = lost * up / glm::max(up + down, Vec3{kLeastShare}), below = Vec3{1} - up - lost_up;

  GgxAlbedo::Split view;
  Vec3 metal_lost{0};
  if (m.metallic > 0.0f) {
    view = single_split(wo_, point_.alpha);
    const float mean = GgxAlbedo::table().average_split(std::sqrt(point_.alpha.x * point_.alpha.y)).full;
    metal_lost = returned_share(point_.metal_f0, 1.0f, mean) * (1.0f - view.full);
  }
  multiple_ = (lost_up * dielectric + metal_lost * m.metallic) * kInvPi;
  diffuse_ = m.base_color * below * (dielectric * (1.0f - point_.transmission) * kInvPi);
  tint_ = m.base_color * (dielectric * point_.transmission);
  multiple_through_ = tint_ * (lost - lost_up) * kInvPi;
  choose_shares(up * dielectric + single_albedo(point_.metal_f0, 1.0f, view) * m.metallic + tint_ * down,
                (diffuse_ + multiple_) * kPi, multiple_through_ * kPi);
}

template <bool kTransmits>
void InterfaceBsdf<kTransmits>::choose_shares(const Vec3& single, const Vec3& matte, const Vec3& matte_through) {
  const float specular = luminance(single);
  const float above = std::max(luminance(matte), 0.0f), below = std::max(luminance(matte_through), 0.0f);
  const float all = specular + above + below;
  if (!(all > 0.0f)) return;
  interface_share_ = specular / all;
  // As in Bsdf. Clear glass consists of little but its boundary, and needs no samples of the other lobes.
  if (interface_share_ < 0.99f) interface_share_ = std::clamp(interface_share_, 0.1f, 0.9f);
  const float rest = above + below;
  above_share_ = rest > 0.0f ? (1.0f - interface_share_) * (above / rest) : 1.0f - interface_share_;
  below_share_ = rest > 0.0f ? (1.0f - interface_share_) * (below / rest) : 0.0f;
}

template <bool kTransmits>
typename InterfaceBsdf<kTransmits>::Facet InterfaceBsdf<kTransmits>::facet(float cosine) const {
  const float dielectric = 1.0f - point_.material.metallic;
  const float schlick = schlick_weight(cosine);
  const Vec3 metal = (point_.metal_f0 + (Vec3{1} - point_.metal_f0) * schlick) * point_.material.metallic;
  float weight = schlick;
  Facet out;
  if constexpr (kTransmits) {
    if (point_.glass != nullptr) {
      const Refraction r = refraction(cosine, point_.eta);
      if (r.total) {
        out.reflected = metal + Vec3{dielectric};
        return out;
      }
      weight = fresnel_weight(r.reflected, f0_of_eta(point_.eta));
      out.cosine = r.cosine;
    }
  }
  const Vec3 fresnel = point_.dielectric_f0 + (Vec3{point_.dielectric_f90} - point_.dielectric_f0) * weight;
  out.reflected = metal + fresnel * dielectric;
  if constexpr (kTransmits) {
    out.through = tint_ * (Vec3{1} - fresnel);
    const float up = luminance(out.reflected), down = luminance(out.through);
    out.reflected_share = up + down > 0.0f ? up / (up + down) : 1.0f;
  }
  return out;
}

template <bool kTransmits>
BsdfValue InterfaceBsdf<kTransmits>::evaluate(const Vec3& wi) const {
  if (wi.z > 0.0f) return reflected(wi);
  if constexpr (kTransmits) {
    if (wi.z < 0.0f) return through(wi);
  }
  return {};
}

template <bool kTransmits>
BsdfValue InterfaceBsdf<kTransmits>::reflected(const Vec3& wi) const {
  BsdfValue value;
  const Vec3 sum = wo_ + wi;
  const float length2 = glm::dot(sum, sum);
  if (length2 > 0.0f) {
    const Vec3 h = sum * (1.0f / std::sqrt(length2));
    const float lambda_o = ggx_lambda(wo_, point_.alpha);
    const float base = ggx_distribution(h, point_.alpha) / (4.0f * wo_.z);
    const Facet f = facet(glm::dot(wo_, h));
    value.f_cos = f.reflected * (base / (1.0f + lambda_o + ggx_lambda(wi, point_.alpha)));
    value.pdf = interface_share_ * f.reflected_share * (base / (1.0f + lambda_o));
  }
  const bool glass = kTransmits && point_.glass != nullptr;
  if (glass || anisotropic_) {
    value.f_cos += (diffuse_ + multiple_) * wi.z;
  } else {
    const GgxAlbedo::Split light = GgxAlbedo::table().split(wi.z, point_.alpha.x);
    const Vec3 coat =
        single_albedo(point_.dielectric_f0, point_.dielectric_f90, light) + returned_ * (1.0f - light.full);
    value.f_cos += (diffuse_ * glm::max(Vec3{1} - coat, Vec3{0}) + multiple_ * (1.0f - light.full)) * wi.z;
  }
  value.pdf += above_share_ * cosine_pdf(wi.z);
  return value;
}

template <bool kTransmits>
BsdfValue InterfaceBsdf<kTransmits>::through(const Vec3& wi) const {
  const bool glass = point_.glass != nullptr;
  const ThroughValue lobe =
      glass ? refracted_value(wo_, wi, point_.alpha, point_.eta) : thin_value(wo_, wi, point_.alpha);
  BsdfValue value;
  if (lobe.pdf > 0.0f) {
    const Facet f = facet(glm::dot(wo_, lobe.h));
    value.f_cos = f.through * lobe.f_cos;
    value.pdf = interface_share_ * (1.0f - f.reflected_share) * lobe.pdf;
  }
  float lost = 1.0f;
  if (!glass && !anisotropic_) lost = 1.0f - GgxAlbedo::table().split(-wi.z, point_.alpha.x).full;
  value.f_cos += multiple_through_ * (lost * -wi.z);
  value.pdf += below_share_ * cosine_pdf(-wi.z);
  return value;
}

template <bool kTransmits>
Vec3 InterfaceBsdf<kTransmits>::sample(float lobe, const Vec2& u) const {
  if (lobe >= interface_share_) {
    const Vec3 w = sample_cosine(u);
    const bool below = kTransmits && lobe >= 1.0f - below_share_;
    return below ? Vec3{w.x, w.y, -w.z} : w;
  }
  const Vec3 h = sample_visible_normal(wo_, point_.alpha, u);
  const float oh = glm::dot(wo_, h);
  const Vec3 mirrored = 2.0f * oh * h - wo_;
  if constexpr (kTransmits) {
    const Facet f = facet(oh);
    if (lobe >= interface_share_ * f.reflected_share) {
      const bool glass = point_.glass != nullptr;
      const Vec3 wi = glass ? refract(wo_, h, point_.eta, f.cosine) : Vec3{mirrored.x, mirrored.y, -mirrored.z};
      return wi.z < 0.0f ? wi : kNowhere;
    }
  }
  // Light that a microfacet sends to the wrong side must not be counted for the other lobe.
  return mirrored.z > 0.0f ? mirrored : kNowhere;
}

template <bool kTransmits>
bool InterfaceBsdf<kTransmits>::is_wide(float lobe) const {
  return lobe >= interface_share_ || point_.alpha.x * point_.alpha.y >= kWideAlpha * kWideAlpha;
}

template class InterfaceBsdf<false>;
template class InterfaceBsdf<true>;

}  // namespace carousel::shading
