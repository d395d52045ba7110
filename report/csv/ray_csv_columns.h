#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/types/ray.h"

namespace carousel::report {

/// Columns of hits.csv; those of a ray file are the first kRayColumns.
inline constexpr std::array<std::string_view, 16> kColumns{
    "ray", "kind", "ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "hit", "t", "instance", "primitive", "u", "v"};
inline constexpr std::size_t kRayColumns = 10;

/// A further column, which stands behind the others only if a ray has flags: the words of those it has, joined by '+'.
/// So each ray of a file can have its own (US 11308683, FIG. 13a: flags of a ray, for features such as culling of back
/// faces).
inline constexpr std::string_view kFlagsColumn = "flags";
struct FlagWord {
  std::string_view word;
  RayFlag flag;
};
inline constexpr std::array<FlagWord, 3> kFlagWords{
    {{"cull_back", kRayCullBack}, {"cull_front", kRayCullFront}, {"force_opaque", kRayForceOpaque}}};
inline constexpr std::uint8_t kWordFlags = kRayCullBack | kRayCullFront | kRayForceOpaque;

/// By RayKind.
inline constexpr std::array<std::string_view, kRayKinds> kRayKindNames{"camera", "bounce", "shadow"};

}  // namespace carousel::report
