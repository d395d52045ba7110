#include "scene/images/image_decode.h"

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/module/module.h"
#include "scene/images/foreign_picture.h"
#include "scene/images/jpeg_decode.h"
#include "scene/images/picture_format.h"
#include "scene/images/png_check.h"
#include "scene/images/png_decode.h"
#include "scene/images/webp_decode.h"

namespace carousel::scene {

namespace {

/// Bytes of a pixel in the picture, and those that a decoder keeps beside it while it works. libwebp keeps a second
/// picture and its transforms. libjpeg-turbo keeps the coefficients of a progressive file (16 bits of each of up to
/// four components).
constexpr std::uint64_t kBytesPerPixel = 4, kWorkPerPixel = 8;

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

/// Calls `take`, and adds the size of the picture to its refusal.
template <class Take>
void of_size(std::uint32_t width, std::uint32_t height, const Take& take) {
  try {
    take();
  } catch (const std::length_error& error) {
    throw std::length_error("of " + std::to_string(width) + " x " + std::to_string(height) + " pixels " + error.what());
  }
}

Image decode_foreign(std::span<const unsigned char> encoded, MemoryBudget& memory, const PictureHint& hint) {
  const PictureFormat format = picture_format(encoded, hint.name);
  if (format.name.empty()) throw std::runtime_error("neither PNG nor JPEG nor WebP");
  try {
    return decode_foreign_picture(encoded, format, hint, memory);
  } catch (const ModuleError& error) {
    throw std::runtime_error(std::string(format.in_text) + ", neither PNG nor JPEG nor WebP, and " + error.what());
  }
}

}  // namespace

void throw_if_too_large(std::uint32_t width, std::uint32_t height, std::uint64_t bytes, MemoryBudget& memory) {
  of_size(width, height, [&] { const MemoryBudget::Loan all = memory.lend(bytes); });
}

Image decode_image(std::span<const unsigned char> encoded, MemoryBudget& memory, const PictureHint& hint) {
  MemoryBudget::Loan work;
  const auto checked = [&](const auto& header) {
    const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
    of_size(header.width, header.height, [&] {
      work = memory.lend(pixels * kWorkPerPixel);
      memory.take(pixels * kBytesPerPixel);
    });
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
  return decode_foreign(encoded, memory, hint);
}

}  // namespace carousel::scene
