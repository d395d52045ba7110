#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/fields/scene.h"
#include "core/types/vec.h"

namespace carousel::scene {

/// A 3D Gaussian: at mean + spread * x its response is exp(-|x|^2 / 2), and it takes that times `opacity` of the light
/// from behind it (B. Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, SIGGRAPH 2023).
struct Gaussian {
  Vec3 mean{0};
  Mat3 spread{
      1.0f};  ///< rotation times standard deviations, with an inverse; one that a node transforms may be sheared
  float opacity = 1;  ///< 0 to 1
  Vec3 color{1};      ///< not negative; from all directions the same
  float reach = 3;    ///< standard deviations from the mean to its end, set by place_gaussians()
};

/// All Gaussians of a scene, which has no other shapes then.
struct GaussianCloud {
  std::vector<Gaussian> shapes;
  bool display = false;  ///< colours are sRGB-encoded, and are blended as they are; else they are linear
  // As configured, by place_gaussians():
  GaussiansConfig::Geometry geometry = GaussiansConfig::Geometry::kEllipsoids;
  float opaque_below = 0;

  bool empty() const { return shapes.empty(); }
};

/// Triangles around a Gaussian: an icosahedron, as of N. Moenne-Loccoz et al., 3D Gaussian Ray Tracing, SIGGRAPH Asia
/// 2024.
inline constexpr std::uint32_t kProxyTriangles = 20;

/// Gaussian::spread of a rotation (x, y, z, w; of any length) and three standard deviations. One that is less than
/// 2^-14 of the largest becomes that, so that there is an inverse. Absent if the rotation has no direction, a deviation
/// is negative, or none is a normal number of single precision.
std::optional<Mat3> spread_of(const double (&rotation)[4], const DVec3& deviations);

/// The colour of spherical harmonics of degree 0 (KHR_gaussian_splatting, Lighting): 0.5 more than their value, and not
/// negative.
Vec3 color_of_harmonics(const Vec3& degree_0);

}  // namespace carousel::scene
