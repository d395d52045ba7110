#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace carousel::shading {

// Both functions write the whole file or nothing (core/system/atomic_file.h), for any extension of `path`. `rgb` is
// linear, row-major from the top left, 3 * width * height floats. Both throw FileError.

/// Writes a picture for display: times 2 to the `exposure`, tone_curve(), sRGB, 8 bit.
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::span<const float> rgb,
               float exposure = 0);

/// Writes a picture for computation: the linear values as 32-bit float, losslessly compressed.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

}  // namespace carousel::shading
