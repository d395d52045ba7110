#include "shading/bsdf/bsdf.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "shading/bsdf/ggx.h"
#include "shading/bsdf/ggx_albedo.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/luminance.h"

namespace carousel::shading {

float widened_roughness(float roughness) {
  return roughness * roughness >= kWideAlpha ? roughness : std::sqrt(kWideAlpha);
}

Bsdf::Bsdf(const MaterialPoint& material, const Vec3& wo) : wo_(wo) {
  const Vec3 albedo = material.base_color * (1.0f - material.metallic);
  f0_ = Vec3{kDielectricF0 * (1.0f - material.metallic)} + material.base_color * material.metallic;
  alpha_ = ggx_alpha(material.roughness);

  const GgxAlbedo& table = GgxAlbedo::table();
  const GgxAlbedo::Pair view = table.directional(wo.z, alpha_), mean = table.average(alpha_);
  diffuse_ = albedo * (kInvPi * (1.0f - view.dielectric) / std::max(1.0f - mean.dielectric, kLeastShare));
  // Light between several microfacets meets Fresnel's factor several times. The result is not linear in F0, so metal
  // and dielectric are mixed afterwards, not before.
  auto scattered_back = [&](const Vec3& f0) {
    const Vec3 fresnel = (20.0f * f0 + 1.0f) * (1.0f / 21.0f);  // Schlick's, averaged over the cosine
    return fresnel * fresnel * mean.metal / (Vec3{1} - fresnel * (1.0f - mean.metal));
  };
  const Vec3 returned =
      glm::mix(scattered_back(Vec3{kDielectricF0}), scattered_back(material.base_color), material.metallic);
  multiple_ = returned * (kInvPi * (1.0f - view.metal) / std::max(1.0f - mean.metal, kLeastShare));

  const float weight = schlick_weight(wo.z);
  const float specular = luminance(f0_ + (Vec3{1} - f0_) * weight) * view.metal;
  const float matte = luminance(albedo) * (1.0f - view.dielectric) + luminance(returned) * (1.0f - view.metal);
  const float all = specular + matte;
  // The probability never gets so small that a bright lobe depends on rare samples of the other.
  specular_share_ = all > 0.0f ? std::clamp(specular / all, 0.1f, 0.9f) : 0.5f;
}

BsdfValue Bsdf::evaluate(const Vec3& wi) const {
  if (!(wi.z > 0.0f)) return {};
  const Vec3 sum = wo_ + wi;
  const float length2 = glm::dot(sum, sum);
  BsdfValue value;
  if (length2 > 0.0f) {
    const Vec3 h = sum * (1.0f / std::sqrt(length2));
    const GgxValue lobe = ggx_value(wo_, wi, h, alpha_);
    const float weight = schlick_weight(glm::dot(wo_, h));
    value.f_cos = (f0_ + (Vec3{1} - f0_) * weight) * lobe.f_cos;
    value.pdf = specular_share_ * lobe.pdf;
  }
  const GgxAlbedo::Pair light = GgxAlbedo::table().directional(wi.z, alpha_);
  value.f_cos += (diffuse_ * (1.0f - light.dielectric) + multiple_ * (1.0f - light.metal)) * wi.z;
  value.pdf += (1.0f - specular_share_) * cosine_pdf(wi.z);
  return value;
}

Vec3 Bsdf::sample(float lobe, const Vec2& u) const {
  if (lobe >= specular_share_) return sample_cosine(u);
  const Vec3 h = sample_visible_normal(wo_, alpha_, u);
  return 2.0f * glm::dot(wo_, h) * h - wo_;
}

bool Bsdf::is_wide(float lobe) const {
  return lobe >= specular_share_ || alpha_ >= kWideAlpha;
}

}  // namespace carousel::shading
