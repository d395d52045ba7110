#pragma once

#include <cstddef>
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
  float opacity = 1;        ///< 0 to 1
  Vec3 color{1};            ///< by harmonics of degree 0 alone, without the bound at 0
  std::uint32_t frame = 0;  ///< its number in GaussianCloud::frames
  float reach = 3;          ///< standard deviations from the mean to its end, set by place_gaussians()
};

inline constexpr int kMostHarmonicDegree = 3;
/// Coefficients of harmonics from degree 1 to `degree`, for each channel.
constexpr std::size_t higher_harmonics(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 1) - 1);
}

/// All Gaussians of a scene, which has no other shapes then.
///
/// A Gaussian's colour is its `color` plus the sum of its harmonics above degree 0 in the direction of the ray, and not
/// negative (KHR_gaussian_splatting, Lighting; with the Condon-Shortley phase, as in Kerbl et al.).
struct GaussianCloud {
  std::vector<Gaussian> shapes;
  int degree = 0;               ///< of the harmonics, up to kMostHarmonicDegree
  std::vector<Vec3> harmonics;  ///< higher_harmonics(degree) for each Gaussian, by degree and order
  /// From the world to the space in which harmonics are given, but for a scale; 0 is the world itself. None: all are
  /// given in the world.
  std::vector<DMat3> frames;
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

/// Gaussian::color of coefficients of degree 0 (KHR_gaussian_splatting, Lighting): 0.5 more than their value.
Vec3 color_of_harmonics(const Vec3& degree_0);

}  // namespace carousel::scene
