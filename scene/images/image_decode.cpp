#include "scene/images/image_decode.h"

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "scene/images/jpeg_decode.h"
#include "scene/images/png_check.h"
#include "scene/images/png_decode.h"
#include "scene/images/webp_decode.h"

namespace carousel::scene {

namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;
/// Deflate packs at most 1032:1, and a PNG byte holds at most 8 pixels; JPEG and pictures worth a WebP stay far below.
constexpr std::uint64_t kMostPixelsPerByte = 8 * 1032;

enum class Format { kNone, kPng, kJpeg, kWebp };

Format format_of(std::span<const unsigned char> bytes) {
  constexpr std::array<unsigned char, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<unsigned char, 3> kJpeg = {0xff, 0xd8, 0xff};
  if (bytes.size() > kPng.size() && std::memcmp(bytes.data(), kPng.data(), kPng.size()) == 0) return Format::kPng;
  if (bytes.size() > kJpeg.size() && std::memcmp(bytes.data(), kJpeg.data(), kJpeg.size()) == 0) return Format::kJpeg;
  if (bytes.size() > 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 && std::memcmp(bytes.data() + 8, "WEBP", 4) == 0)
    return Format::kWebp;
  return Format::kNone;
}

/// Before anything is allocated.
void check_size(std::uint64_t width, std::uint64_t height, std::size_t bytes) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (width * height > kMostPixels) throw std::runtime_error(size + " pixels; at most 67108864 in all are read");
  if (width * height > kMostPixelsPerByte * bytes) {
    throw std::runtime_error(size + " pixels announced in only " + std::to_string(bytes) + " bytes");
  }
}

}  // namespace

Image decode_image(std::span<const unsigned char> encoded) {
  const auto checked = [&](const auto& header) {
    check_size(header.width, header.height, encoded.size());
    return header;
  };
  switch (format_of(encoded)) {
    case Format::kPng:
      if (const char* fault = png_fault(encoded)) throw std::runtime_error(std::string("broken: ") + fault);
      checked(read_png_header(encoded));
      return decode_png(encoded);
    case Format::kJpeg:
      return decode_jpeg(encoded, checked(read_jpeg_header(encoded)));
    case Format::kWebp:
      return decode_webp(encoded, checked(read_webp_header(encoded)));
    case Format::kNone:
      break;
  }
  throw std::runtime_error("neither PNG nor JPEG nor WebP");
}

}  // namespace carousel::scene
