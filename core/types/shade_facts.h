#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace carousel {

/// The numbers of a completed ray that a shader program finds in its registers, and by which it branches.
enum class ShadeFact : std::uint8_t {
  kHit,       ///< 1 if the ray hit a surface
  kShadow,    ///< 1 for a shadow ray
  kBounce,    ///< surfaces of the path before this ray
  kLast,      ///< 1 if the surface sends no bounce ray
  kLights,    ///< lights of the scene
  kEmissive,  ///< 1 if the surface gives off light
  kAlpha,     ///< 0 opaque, 1 a mask, 2 blended
  kLookups,   ///< filtered texture lookups of the surface
  kProducts,  ///< products of the effects of the surface, beyond those of a plain one
};
inline constexpr auto kShadeFactNames = std::to_array<std::string_view>(
    {"hit", "shadow", "bounce", "last", "lights", "emissive", "alpha", "lookups", "products"});
inline constexpr std::size_t kShadeFacts = kShadeFactNames.size();

/// A read of data that shading needs, from the start of the table in which it lies.
struct DataRead {
  std::uint64_t offset = 0;
  std::uint32_t bytes = 0;
  friend auto operator<=>(const DataRead&, const DataRead&) = default;
};

/// The tables that shader workers read: those of the scene, that of pages, and rasterised samples.
enum class ShadeData : std::uint8_t { kMaterial, kVertices, kTexels, kPages, kFirstHits };
inline constexpr std::size_t kShadeData = 5;

/// A completed ray as a shader program sees it.
struct ShadeFacts {
  std::array<float, kShadeFacts> value{};
  std::vector<DataRead> material, vertices;    ///< empty if it hit nothing that has them
  std::vector<std::vector<DataRead>> lookups;  ///< texels, by lookup

  float& operator[](ShadeFact fact) { return value[static_cast<std::size_t>(fact)]; }
};

}  // namespace carousel
