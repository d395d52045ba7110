#include "shading/bsdf/ggx_albedo.h"

#include <algorithm>
#include <cmath>

#include "shading/bsdf/ggx.h"

namespace carousel::shading {

namespace {

struct Integral {
  float full = 0;     // with F = 1
  float schlick = 0;  // weighted by (1 - cos)^5
};

Integral integrate_albedo(float cos_theta, float alpha) {
  constexpr int kStrata = 20;
  const Vec3 wo{std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta)), 0.0f, cos_theta};
  Integral sum;
  for (int i = 0; i < kStrata; ++i) {
    for (int j = 0; j < kStrata; ++j) {
      // Samples stand closer together where microfacets are seen edge-on, since masking changes fastest there.
      const float v = 1.0f - (float(j) + 0.5f) / kStrata, stretch = 2.0f * v;
      const Vec2 u{0.5f * (float(i) + 0.5f) / kStrata, 1.0f - v * v};  // the other half is this one's mirror image
      const Vec3 h = sample_visible_normal(wo, alpha, u);
      const float oh = glm::dot(wo, h);
      const Vec3 wi = 2.0f * oh * h - wo;
      if (wi.z <= 0.0f) continue;
      const GgxValue value = ggx_value(wo, wi, h, alpha);
      const float weight = stretch * value.f_cos / value.pdf;
      sum.full += weight;
      sum.schlick += weight * schlick_weight(oh);
    }
  }
  constexpr float kInv = 1.0f / (kStrata * kStrata);
  return {sum.full * kInv, sum.schlick * kInv};
}

GgxAlbedo::Pair lerp(const GgxAlbedo::Pair& a, const GgxAlbedo::Pair& b, float t) {
  return {a.metal + t * (b.metal - a.metal), a.dielectric + t * (b.dielectric - a.dielectric)};
}

GgxAlbedo::Split lerp(const GgxAlbedo::Split& a, const GgxAlbedo::Split& b, float t) {
  return {a.full + t * (b.full - a.full), a.schlick + t * (b.schlick - a.schlick)};
}

/// Position of `x`, 0 to 1, between the entries of a row.
template <class Row>
auto between(const Row& row, float x) {
  const float scaled = std::clamp(x, 0.0f, 1.0f) * float(row.size() - 1);
  const std::size_t i = std::min(std::size_t(scaled), row.size() - 2);
  return lerp(row[i], row[i + 1], scaled - float(i));
}
template <class Row>
auto along(const Row& row, float cos_theta) {
  return between(row, std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)));
}

/// Cosine-weighted mean of a function of the cosine.
template <class F>
float cosine_mean(const F& f) {
  constexpr int kSteps = 128;
  float sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float cos_theta = (float(i) + 0.5f) / kSteps;
    sum += 2.0f * cos_theta * f(cos_theta);
  }
  return sum / kSteps;
}

}  // namespace

GgxAlbedo::GgxAlbedo() {
  for (int r = 0; r < kSize; ++r) {
    const float roughness = float(r) / (kSize - 1);
    const float alpha = ggx_alpha(roughness);
    for (int c = 0; c < kSize; ++c) {
      const float x = std::max(float(c) / (kSize - 1), 0.01f);
      const Integral integral = integrate_albedo(x * x, alpha);
      split_[r][c] = {integral.full, integral.schlick};
      directional_[r][c] = {integral.full, kDielectricF0 * (integral.full - integral.schlick) + integral.schlick};
    }
    const float metal = cosine_mean([&](float cos_theta) { return at(directional_[r], cos_theta).metal; });
    // The multiple-scattering term of bsdf.cpp for F0 = 0.04.
    const float fresnel = (20.0f * kDielectricF0 + 1.0f) / 21.0f;
    const float returned = fresnel * fresnel * metal / (1.0f - fresnel * (1.0f - metal));
    for (Pair& pair : directional_[r]) pair.dielectric += returned * (1.0f - pair.metal);
    average_[r] = {metal, cosine_mean([&](float cos_theta) { return at(directional_[r], cos_theta).dielectric; })};
    average_split_[r] = {cosine_mean([&](float cos_theta) { return along(split_[r], cos_theta).full; }),
                         cosine_mean([&](float cos_theta) { return along(split_[r], cos_theta).schlick; })};
  }
}

const GgxAlbedo& GgxAlbedo::table() {
  static const GgxAlbedo albedo;
  return albedo;
}

GgxAlbedo::Pair GgxAlbedo::at(const Row& row, float cos_theta) {
  const float x = std::sqrt(std::clamp(cos_theta, 0.0f, 1.0f)) * (kSize - 1);
  const int c = std::min(int(x), kSize - 2);
  return lerp(row[c], row[c + 1], x - float(c));
}

GgxAlbedo::Pair GgxAlbedo::directional(float cos_theta, float alpha) const {
  const float y = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (kSize - 1);
  const int r = std::min(int(y), kSize - 2);
  return lerp(at(directional_[r], cos_theta), at(directional_[r + 1], cos_theta), y - float(r));
}

GgxAlbedo::Pair GgxAlbedo::average(float alpha) const {
  const float y = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (kSize - 1);
  const int r = std::min(int(y), kSize - 2);
  return lerp(average_[r], average_[r + 1], y - float(r));
}

GgxAlbedo::Split GgxAlbedo::split(float cos_theta, float alpha) const {
  const float y = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (kSize - 1);
  const int r = std::min(int(y), kSize - 2);
  return lerp(along(split_[r], cos_theta), along(split_[r + 1], cos_theta), y - float(r));
}

GgxAlbedo::Split GgxAlbedo::average_split(float alpha) const {
  return between(average_split_, std::sqrt(std::clamp(alpha, 0.0f, 1.0f)));
}

}  // namespace carousel::shading
