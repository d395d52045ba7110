#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace carousel::scene {

/// A Gaussian as a file of 3D Gaussian splatting has it.
struct PlyGaussian {
  float x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
  float color[3] = {0, 0, 0};
  float higher[45] = {};  ///< harmonics above degree 0, a channel after the other
  float opacity = 0, scale[3] = {0, 0, 0}, rotation[4] = {1, 0, 0, 0};
};
static_assert(sizeof(PlyGaussian) == 62 * sizeof(float));

/// The properties f_rest_* of harmonics up to a degree.
inline std::size_t rest_of(int degree) {
  return static_cast<std::size_t>(3 * ((degree + 1) * (degree + 1) - 1));
}

inline std::string gaussian_ply_header(std::size_t count, int degree = 1) {
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment made by a test\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"})
    out += std::string("property float ") + name + "\n";
  for (std::size_t i = 0; i < rest_of(degree); ++i) out += "property float f_rest_" + std::to_string(i) + "\n";
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    out += std::string("property float ") + name + "\n";
  return out + "end_header\n";
}

/// The bytes of a file.
inline std::string gaussian_ply(const std::vector<PlyGaussian>& gaussians, int degree = 1) {
  std::string out = gaussian_ply_header(gaussians.size(), degree);
  const auto append = [&](const float* from, std::size_t count) {
    out.append(reinterpret_cast<const char*>(from), count * sizeof(float));
  };
  for (const PlyGaussian& one : gaussians) {
    append(&one.x, 9);
    append(one.higher, rest_of(degree));
    append(&one.opacity, 8);
  }
  return out;
}

}  // namespace carousel::scene
