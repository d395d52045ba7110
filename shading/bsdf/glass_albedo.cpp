#include "shading/bsdf/glass_albedo.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/ggx.h"
#include "shading/bsdf/ggx_anisotropic.h"
#include "shading/bsdf/visible_normals.h"

namespace carousel::shading {

namespace {

using Shares = GlassAlbedo::Shares;

Shares lerp(const Shares& a, const Shares& b, float t) {
  return {a.reflected + t * (b.reflected - a.reflected), a.reflected_w + t * (b.reflected_w - a.reflected_w),
          a.total + t * (b.total - a.total), a.through + t * (b.through - a.through),
          a.through_w + t * (b.through_w - a.through_w)};
}

/// Sums the light of `wo` over facets, by where each facet sends it.
class FacetSum {
 public:
  FacetSum(const Vec3& wo, const Vec2& alpha, float eta)
      : wo_(wo), alpha_(alpha), eta_(eta), f0_(f0_of_eta(eta)), lambda_o_(ggx_lambda(wo, alpha)) {}

  void add(const Vec3& h, float share) {
    const float oh = glm::dot(wo_, h);
    const Refraction r = refraction(oh, eta_);
    const float w = fresnel_weight(r.reflected, f0_);
    const Vec3 mirrored = 2.0f * oh * h - wo_;
    if (mirrored.z > 0.0f) {
      const float weight = unmasked(mirrored) * share;
      if (r.total) {
        sum_.total += weight;
      } else {
        sum_.reflected += weight;
        sum_.reflected_w += weight * w;
      }
    }
    if (r.total) return;
    const Vec3 refracted = refract(wo_, h, eta_, r.cosine);
    if (refracted.z >= 0.0f) return;
    const float weight = unmasked(refracted) * share;
    sum_.through += weight;
    sum_.through_w += weight * w;
  }
  const Shares& sum() const { return sum_; }

 private:
  float unmasked(const Vec3& wi) const { return (1.0f + lambda_o_) / (1.0f + lambda_o_ + ggx_lambda(wi, alpha_)); }

  Vec3 wo_;
  Vec2 alpha_;
  float eta_, f0_, lambda_o_;
  Shares sum_;
};

Shares integrate(float cos_theta, float alpha, float eta) {
  constexpr int kStrata = 28;
  const Vec3 wo{std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta)), 0.0f, cos_theta};
  FacetSum sum(wo, Vec2{alpha}, eta);
  for (int i = 0; i < kStrata; ++i) {
    for (int j = 0; j < kStrata; ++j) {
      // Samples stand closer together where microfacets are seen edge-on: masking and refraction change fastest there.
      const float v = 1.0f - (float(j) + 0.5f) / kStrata, stretch = 2.0f * v;
      const Vec2 u{0.5f * (float(i) + 0.5f) / kStrata, 1.0f - v * v};  // the other half is this one's mirror image
      sum.add(sample_visible_normal(wo, alpha, u), stretch / (kStrata * kStrata));
    }
  }
  return sum.sum();
}

}  // namespace

GlassAlbedo::Shares glass_shares(const Vec3& wo, const Vec2& alpha, float eta) {
  FacetSum sum(wo, alpha, eta);
  visit_visible_normals(fine_lattice(), wo, alpha, [&](const Vec3& h, float weight) { sum.add(h, weight); });
  return sum.sum();
}

GlassAlbedo::GlassAlbedo(float eta) {
  for (int r = 0; r < kRoughnesses; ++r) {
    for (int c = 0; c < kCosines; ++c) {
      const float x = std::max(float(c) / (kCosines - 1), 0.01f);
      cells_[r][c] = integrate(x * x, ggx_alpha(float(r) / (kRoughnesses - 1)), eta);
    }
  }
}

const GlassAlbedo& GlassAlbedo::of(float eta) {
  static std::mutex mutex;
  static std::map<std::uint32_t, std::unique_ptr<const GlassAlbedo>> known;
  const std::scoped_lock lock(mutex);
  auto& table = known[std::bit_cast<std::uint32_t>(eta)];
  if (!table) table.reset(new GlassAlbedo(eta));
  return *table;
}

GlassAlbedo::Shares GlassAlbedo::directional(float cos_theta, float alpha) const {
  const float x = std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)) * (kCosines - 1);
  const float y = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (kRoughnesses - 1);
  const int c = std::min(int(x), kCosines - 2), r = std::min(int(y), kRoughnesses - 2);
  const float s = x - float(c), t = y - float(r);
  return lerp(lerp(cells_[r][c], cells_[r][c + 1], s), lerp(cells_[r + 1][c], cells_[r + 1][c + 1], s), t);
}

}  // namespace carousel::shading
