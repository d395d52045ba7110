#pragma once

#include "core/types/vec.h"

namespace carousel::shading {

/// Linear radiance to displayable linear RGB in [0, 1]: the Khronos PBR Neutral tone mapper (Khronos Group,
/// 2024). It keeps colours unchanged up to 0.8 - 0.04, then compresses the brightest channel and fades towards
/// white. It was made for glTF assets, whose base colours stay recognisable.
Vec3 tone_curve(const Vec3& radiance);

}  // namespace carousel::shading
