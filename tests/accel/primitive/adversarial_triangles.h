#pragma once

#include <ios>
#include <sstream>
#include <string>

#include "accel/certificate/triangle_cases.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {

inline constexpr const char* kTriangleCaseNames[kTriangleCaseKinds] = {
    "Random",        "EdgeAimed", "CornerAimed", "Grid",   "ScaledGrid",
    "WildExponents", "Sliver",    "Degenerate",  "EdgeOn", "OnSurface"};

/// With every bit, to be seen again.
inline std::string text(const TriangleCase& c) {
  std::ostringstream out;
  out << std::hexfloat;
  const auto put = [&](const char* name, const Vec3& v) {
    out << name << " " << v.x << " " << v.y << " " << v.z << "; ";
  };
  put("origin", c.ray.origin);
  put("direction", c.ray.direction);
  for (const Vec3& corner : c.corners) put("corner", corner);
  return out.str();
}

}  // namespace carousel::accel
