#pragma once

#include <cstdint>
#include <span>

namespace carousel::scene {

/// Why these bytes, which start with PNG's signature, are no whole PNG file, or nullptr when IHDR comes
/// first, IEND is there, every chunk up to it lies inside and critical chunks have their right checksum (W3C,
/// "PNG Specification", third edition, sections 5.3 and 5.6). Pixels are not looked at. libpng
/// decodes some files that fail this.
const char* png_fault(std::span<const unsigned char> bytes);

struct PngHeader {
  std::uint32_t width = 0, height = 0;
};

/// Size of a PNG picture that png_fault() has nothing against.
PngHeader read_png_header(std::span<const unsigned char> encoded);

}  // namespace carousel::scene
