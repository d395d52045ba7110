#pragma once

#include "core/types/vec.h"

namespace carousel::shading {

/// Luminance of linear RGB with the primaries of ITU-R BT.709.
inline float luminance(const Vec3& rgb) {
  return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}

inline float max_component(const Vec3& v) {
  const float xy = v.x > v.y ? v.x : v.y;
  return xy > v.z ? xy : v.z;
}

}  // namespace carousel::shading
