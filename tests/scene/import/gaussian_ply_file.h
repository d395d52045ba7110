#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace carousel::scene {

/// A Gaussian as a file of 3D Gaussian splatting has it.
struct PlyGaussian {
  float x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
  float color[3] = {0, 0, 0};
  float higher[9] = {};  ///< harmonics of degree 1
  float opacity = 0, scale[3] = {0, 0, 0}, rotation[4] = {1, 0, 0, 0};
};
static_assert(sizeof(PlyGaussian) == 26 * sizeof(float));

inline std::string gaussian_ply_header(std::size_t count) {
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment made by a test\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"})
    out += std::string("property float ") + name + "\n";
  for (int i = 0; i < 9; ++i) out += "property float f_rest_" + std::to_string(i) + "\n";
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    out += std::string("property float ") + name + "\n";
  return out + "end_header\n";
}

/// The bytes of a file.
inline std::string gaussian_ply(const std::vector<PlyGaussian>& gaussians) {
  std::string out = gaussian_ply_header(gaussians.size());
  out.append(reinterpret_cast<const char*>(gaussians.data()), gaussians.size() * sizeof(PlyGaussian));
  return out;
}

}  // namespace carousel::scene
