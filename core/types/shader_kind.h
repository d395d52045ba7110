#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carousel {

/// What a shader worker runs code for, in the order of Workload::shader(): a ray that left the scene, a shadow ray, a
/// hit by the class of its surface (shading/tracer/surface_class.h), the making of camera rays, and any-hit calls.
inline constexpr auto kShaderKindNames = std::to_array<std::string_view>(
    {"miss", "shadow", "unlit", "plain", "textured", "layered", "opaque", "layered_opaque", "transmissive",
     "layered_transmissive", "anything", "camera", "any_hit"});
inline constexpr std::size_t kShaderKinds = kShaderKindNames.size();
inline constexpr std::uint32_t kFirstSurfaceKind = 2, kAnyHitKind = kShaderKinds - 1, kCameraKind = kAnyHitKind - 1;

}  // namespace carousel
