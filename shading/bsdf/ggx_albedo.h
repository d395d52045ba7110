#pragma once

#include <array>

namespace carousel::shading {

/// The share of light that one bounce between GGX microfacets returns, tabulated over direction and roughness. The
/// single-scattering lobe loses the rest, and bsdf.h adds it again: C. Kulla, A. Conty, "Revisiting physically based
/// shading at Imageworks", SIGGRAPH course, 2017.
class GgxAlbedo {
 public:
  /// The one table; computed on first use (a few milliseconds), then read-only. Any thread.
  static const GgxAlbedo& table();

  struct Pair {
    float metal = 0;  ///< F = 1: the albedo of the bare lobe
    float dielectric =
        0;  ///< F0 = 0.04 with the lost energy returned; a diffuse base below does not receive this share
  };
  /// Share of light arriving from (or leaving to) direction cosine `cos_theta` that is reflected.
  Pair directional(float cos_theta, float alpha) const;
  /// The cosine-weighted mean over all directions.
  Pair average(float alpha) const;

  /// The bare lobe's albedo is f0 * (full - schlick) + f90 * schlick for any Fresnel factor of Schlick's form.
  struct Split {
    float full = 0, schlick = 0;
  };
  Split split(float cos_theta, float alpha) const;
  Split average_split(float alpha) const;

 private:
  GgxAlbedo();
  // Nodes are evenly spaced in sqrt(cosine) and in sqrt(alpha), since the albedo changes fastest near 0.
  static constexpr int kSize = 32;
  using Row = std::array<Pair, kSize>;
  static Pair at(const Row& row, float cos_theta);

  std::array<Row, kSize> directional_;  // [roughness][cosine]
  std::array<Pair, kSize> average_;
  std::array<std::array<Split, kSize>, kSize> split_;
  std::array<Split, kSize> average_split_;
};

}  // namespace carousel::shading
