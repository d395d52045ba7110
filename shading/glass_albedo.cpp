#include "shading/glass_albedo.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "shading/fresnel.h"
#include "shading/ggx.h"

namespace carousel::shading {

namespace {

using Shares = GlassAlbedo::Shares;

Shares lerp(const Shares& a, const Shares& b, float t) {
  return {a.reflected + t * (b.reflected - a.reflected), a.reflected_w + t * (b.reflected_w - a.reflected_w),
          a.total + t * (b.total - a.total), a.through + t * (b.through - a.through),
          a.through_w + t * (b.through_w - a.through_w)};
}

Shares integrate(float cos_theta, float alpha, float eta) {
  constexpr int kStrata = 28;
  const float f0 = f0_of_eta(eta);
  const Vec3 wo{std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta)), 0.0f, cos_theta};
  const float lambda_o = ggx_lambda(wo, alpha);
  const auto unmasked = [&](const Vec3& wi) { return (1.0f + lambda_o) / (1.0f + lambda_o + ggx_lambda(wi, alpha)); };
  Shares sum;
  for (int i = 0; i < kStrata; ++i) {
    for (int j = 0; j < kStrata; ++j) {
      // Closer together where microfacets are seen edge-on: there masking and refraction change fastest.
      const float v = 1.0f - (float(j) + 0.5f) / kStrata, stretch = 2.0f * v;
      const Vec2 u{0.5f * (float(i) + 0.5f) / kStrata, 1.0f - v * v};   // the other half is this one's mirror image
      const Vec3 h = sample_visible_normal(wo, alpha, u);
      const float oh = glm::dot(wo, h);
      const Refraction r = refraction(oh, eta);
      const float w = fresnel_weight(r.reflected, f0);
      const Vec3 mirrored = 2.0f * oh * h - wo;
      if (mirrored.z > 0.0f) {
        const float weight = unmasked(mirrored) * stretch;
        if (r.total) {
          sum.total += weight;
        } else {
          sum.reflected += weight;
          sum.reflected_w += weight * w;
        }
      }
      if (r.total) continue;
      const Vec3 refracted = refract(wo, h, eta, r.cosine);
      if (refracted.z >= 0.0f) continue;
      const float weight = unmasked(refracted) * stretch;
      sum.through += weight;
      sum.through_w += weight * w;
    }
  }
  constexpr float kInv = 1.0f / (kStrata * kStrata);
  return {sum.reflected * kInv, sum.reflected_w * kInv, sum.total * kInv, sum.through * kInv, sum.through_w * kInv};
}

}  // namespace

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
