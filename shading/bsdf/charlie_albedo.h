#pragma once

#include <array>

namespace carousel::shading {

/// Share of light that white sheen reflects, over direction and roughness. The layers below do not receive this share.
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
