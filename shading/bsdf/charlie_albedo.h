#pragma once

#include <array>

namespace carousel::shading {

/// Share of light that white sheen sends back, over direction and roughness: what the layers below are denied.
class CharlieAlbedo {
 public:
  /// The one table; computed on first use (some 100 ms), then read-only. Any thread.
  static const CharlieAlbedo& table();

  float directional(float cos_theta, float alpha) const;

 private:
  CharlieAlbedo();
  static constexpr int kSize = 32;
  std::array<std::array<float, kSize>, kSize> cells_;  // [sqrt(alpha)][sqrt(cosine)]
};

}  // namespace carousel::shading
