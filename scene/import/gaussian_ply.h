#pragma once

#include <filesystem>

#include "scene/model/scene.h"

namespace carousel::scene {

/// True for a PLY file whose header has the property `f_dc_0`, as files of 3D Gaussian splatting have (B. Kerbl et al.,
/// SIGGRAPH 2023, whose program writes and names these properties).
bool is_gaussian_ply(const std::filesystem::path& file);

/// Reads the Gaussians of such a file, which must be binary, little endian: places `x y z`; colours as harmonics of
/// degree 0, `f_dc_0` to `f_dc_2`, sRGB-encoded; `opacity` as a logit; `scale_0` to `scale_2` as natural logarithms of
/// standard deviations; `rot_0` to `rot_3` as a quaternion with w first. `f_rest_*`, the harmonics of degree 1 to 3,
/// are 0, 9, 24 or 45. Other properties are left out. The axes stay as they are. Throws SceneError with the line of the
/// header, or the number of the Gaussian.
Scene load_gaussian_ply(const std::filesystem::path& file);

}  // namespace carousel::scene
