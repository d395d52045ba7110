#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/vec.h"

namespace carousel::scene {

/// Light from all directions, in longitude and latitude. The middle of the picture lies along -Z, what is to the right
/// of it along +X, the upper edge along +Y and the lower one along -Y. Left and right edge are one meridian.
struct SkyMap {
  std::string name;                     ///< of the file
  std::uint32_t width = 0, height = 0;  ///< 0: there is no map
  std::vector<Vec3> texels;             ///< linear radiance, 0 to kMostRadiance, row-major from the top left
  float rotation = 0;                   ///< turns about +Y, counter-clockwise as seen from above; 0 to below 1

  /// More than any film holds, and so little that sums over maps stay finite in float.
  static constexpr float kMostRadiance = 1e12f;

  bool empty() const { return texels.empty(); }
};

/// True if light comes from anywhere.
inline bool is_lit(const SkyMap& map) {
  for (const Vec3& texel : map.texels)
    if (texel.x > 0 || texel.y > 0 || texel.z > 0) return true;
  return false;
}

}  // namespace carousel::scene
