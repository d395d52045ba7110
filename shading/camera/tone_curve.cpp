#include "shading/camera/tone_curve.h"

#include <algorithm>

#include <glm/common.hpp>

#include "shading/math/luminance.h"

namespace carousel::shading {

Vec3 tone_curve(const Vec3& radiance) {
  constexpr float kF90 = 0.04f;          // added by a dielectric's reflection; subtracted from the toe
  constexpr float kStart = 0.8f - kF90;  // where compression begins
  constexpr float kDesaturation = 0.15f;
  Vec3 color = glm::max(radiance, Vec3{0});
  const float least = std::min({color.x, color.y, color.z});
  const float offset = least < 2.0f * kF90 ? least - least * least / (4.0f * kF90) : kF90;
  color -= offset;
  const float peak = max_component(color);
  if (!(peak >= kStart)) return glm::clamp(color, 0.0f, 1.0f);
  constexpr float kRange = 1.0f - kStart;
  const float compressed = 1.0f - kRange * kRange / (peak + kRange - kStart);
  color *= compressed / peak;
  const float towards_white = 1.0f - 1.0f / (kDesaturation * (peak - compressed) + 1.0f);
  return glm::clamp(glm::mix(color, Vec3{compressed}, towards_white), 0.0f, 1.0f);
}

}  // namespace carousel::shading
