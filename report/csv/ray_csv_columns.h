#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "core/types/ray.h"

namespace carousel::report {

/// Columns of hits.csv; those of a ray file are the first kRayColumns.
inline constexpr std::array<std::string_view, 16> kColumns{
    "ray", "kind", "ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "hit", "t", "instance", "primitive", "u", "v"};
inline constexpr std::size_t kRayColumns = 10;

/// By RayKind.
inline constexpr std::array<std::string_view, kRayKinds> kRayKindNames{"camera", "bounce", "shadow"};

}  // namespace carousel::report
