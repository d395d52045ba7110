#include "shading/bsdf/layered_bsdf.h"

#include <algorithm>
#include <cmath>

#include "shading/bsdf/charlie.h"
#include "shading/bsdf/charlie_albedo.h"
#include "shading/bsdf/ggx.h"
#include "shading/bsdf/ggx_albedo.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/luminance.h"
#include "shading/math/shading_basis.h"

namespace carousel::shading {

namespace {

/// A sampling weight large enough that a layer's own light does not depend on rare samples of the other lobes; 0 for an
/// absent layer.
float share_of(float albedo) {
  return albedo > 0.0f ? std::clamp(albedo, 0.1f, 0.4f) : 0.0f;
}

}  // namespace

Layers::Layers(const LayerPoint& point, const Vec3& wo)
    : point_(point),
      wo_(wo),
      coat_wo_(ShadingBasis(point.coat_normal).to_local(wo)),
      coat_alpha_(ggx_alpha(point.coat_roughness)),
      sheen_alpha_(charlie_alpha(point.sheen_roughness)) {
  const GgxAlbedo& table = GgxAlbedo::table();
  const GgxAlbedo::Pair view = table.directional(coat_wo_.z, coat_alpha_), mean = table.average(coat_alpha_);
  const float fresnel = (20.0f * kDielectricF0 + 1.0f) * (1.0f / 21.0f);
  const float returned = fresnel * fresnel * mean.metal / (1.0f - fresnel * (1.0f - mean.metal));
  coat_multiple_ = returned * kInvPi * (1.0f - view.metal) / std::max(1.0f - mean.metal, kLeastShare);

  const float coat = point_.coat * view.dielectric;
  const float sheen = CharlieAlbedo::table().directional(wo.z, sheen_alpha_);
  below_coat_ = 1.0f - coat;
  below_ = below_coat_ * (1.0f - max_component(point_.sheen) * sheen);
  coat_share_ = share_of(coat);
  sheen_share_ = share_of(luminance(point_.sheen) * sheen);
}

void Layers::add(const Vec3& wi, BsdfValue& value) const {
  value.f_cos *= below_;
  value.pdf *= 1.0f - coat_share_ - sheen_share_;
  if (!(wi.z > 0.0f)) return;
  value.f_cos += point_.sheen * (below_coat_ * charlie_f_cos(wo_, wi, sheen_alpha_));
  value.pdf += sheen_share_ * (0.5f * kInvPi);

  const Vec3 coat_wi = ShadingBasis(point_.coat_normal).to_local(wi);
  const Vec3 sum = coat_wo_ + coat_wi;
  const float length2 = glm::dot(sum, sum);
  if (!(coat_wi.z > 0.0f) || !(length2 > 0.0f)) return;
  const Vec3 h = sum * (1.0f / std::sqrt(length2));
  const GgxValue lobe = ggx_value(coat_wo_, coat_wi, h, coat_alpha_);
  const float weight = schlick_weight(glm::dot(coat_wo_, h));
  const GgxAlbedo::Pair light = GgxAlbedo::table().directional(coat_wi.z, coat_alpha_);
  const float own = (kDielectricF0 + (1.0f - kDielectricF0) * weight) * lobe.f_cos +
                    coat_multiple_ * (1.0f - light.metal) * coat_wi.z;
  value.f_cos += Vec3{point_.coat * own};
  value.pdf += coat_share_ * lobe.pdf;
}

bool Layers::shared(float& lobe, bool& coat) const {
  coat = lobe < coat_share_;
  const float layers = coat_share_ + sheen_share_;
  if (lobe < layers) return true;
  lobe = std::min((lobe - layers) / (1.0f - layers), 0x1.fffffep-1f);
  return false;
}

bool Layers::sample(float& lobe, const Vec2& u, Vec3& wi) const {
  bool coat = false;
  if (!shared(lobe, coat)) return false;
  if (coat) {
    const Vec3 h = sample_visible_normal(coat_wo_, coat_alpha_, u);
    wi = ShadingBasis(point_.coat_normal).to_world(2.0f * glm::dot(coat_wo_, h) * h - coat_wo_);
    if (!(wi.z > 0.0f)) wi = {1, 0, 0};  // a direction below must not be counted as the base's transmitted light
    return true;
  }
  const SinCos phi = sin_cos_turns(u.y);  // uniform over the hemisphere, since the lobe is strongest at the horizon
  const float sine = std::sqrt(std::max(0.0f, 1.0f - u.x * u.x));
  wi = {sine * phi.cos, sine * phi.sin, u.x};
  return true;
}

bool Layers::is_wide(float& lobe, bool& wide) const {
  bool coat = false;
  if (!shared(lobe, coat)) return false;
  wide = !coat || coat_alpha_ >= kWideAlpha;
  return true;
}

}  // namespace carousel::shading
