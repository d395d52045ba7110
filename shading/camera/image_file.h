#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/config/fields/image.h"

namespace carousel::shading {

// The functions that write a file write the whole file or nothing (core/system/atomic_file.h), for any extension of
// `path`. `rgb` is linear, row-major from the top left, 3 * width * height floats. They throw FileError.

/// Writes a picture for display: times 2 to the `exposure`, tone_curve(), sRGB, 8 bit.
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::span<const float> rgb,
               float exposure = 0);

/// Writes a picture whose bytes, three a pixel, are sRGB already.
void write_png_bytes(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> rgb);

/// Writes a picture for computation: the linear values as 32-bit float, losslessly compressed.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

/// Writes a picture in a format, those above by these functions and others by the module pictures. Formats of floats
/// hold the linear values, others the picture for display.
void write_picture(const std::filesystem::path& path, PictureFile format, std::uint32_t width, std::uint32_t height,
                   std::span<const float> rgb, float exposure);

/// Makes sure that all these formats can be written, so that a run does not find out at its end. Throws a ConfigError
/// of image.files that names the module where it is missing.
void require_picture_files(const std::vector<PictureFile>& formats);

}  // namespace carousel::shading
