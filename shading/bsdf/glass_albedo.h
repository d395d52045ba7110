#pragma once

#include <array>

#include "core/types/vec.h"

namespace carousel::shading {

/// The shares of light that a rough boundary with the exact Fresnel factor F reflects and refracts, over direction and
/// roughness. Specular weights and colours change F = f0 + (1 - f0) w to F' = f0' + (f90' - f0') w, so the table holds
/// sums that are linear in w.
class GlassAlbedo {
 public:
  /// `eta`: index below over index above, positive. Computed on first use (some 40 ms) and never freed. Any thread.
  static const GlassAlbedo& of(float eta);

  /// The sum is within half a percent. The single shares of smooth boundaries are off by up to 9 % between the two
  /// nodes next to the critical angle, where they jump.
  struct Shares {
    float reflected = 0;    ///< by microfacets that could refract, if F' were 1
    float reflected_w = 0;  ///< `reflected`, weighted by w
    float total = 0;        ///< reflected totally
    float through = 0;      ///< refracted, if F' were 0
    float through_w = 0;    ///< `through`, weighted by w
  };
  Shares directional(float cos_theta, float alpha) const;

 private:
  explicit GlassAlbedo(float eta);
  static constexpr int kRoughnesses = 20, kCosines = 48;
  std::array<std::array<Shares, kCosines>, kRoughnesses> cells_;  // evenly spaced in their square roots, as GgxAlbedo's
};

/// The shares at one hit, for two roughnesses, and exact at the critical angle as well. Computed from 610 facets in
/// some 15 us.
GlassAlbedo::Shares glass_shares(const Vec3& wo, const Vec2& alpha, float eta);

/// w of F = f0 + (1 - f0) w.
inline float fresnel_weight(float reflected, float f0) {
  return f0 < 1.0f ? (reflected - f0) / (1.0f - f0) : 0.0f;
}

}  // namespace carousel::shading
