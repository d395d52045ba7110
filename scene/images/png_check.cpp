#include "scene/images/png_check.h"

#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace carousel::scene {

namespace {

std::uint32_t read_u32(std::span<const unsigned char> bytes, std::size_t at) {  // big-endian
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 | std::uint32_t{bytes[at + 2]} << 8 |
         bytes[at + 3];
}

/// CRC-32 as in annex D of the specification.
std::uint32_t checksum(std::span<const unsigned char> bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> out{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      out[n] = c;
    }
    return out;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (const unsigned char byte : bytes) crc = table[(crc ^ byte) & 0xff] ^ (crc >> 8);
  return ~crc;
}

}  // namespace

const char* png_fault(std::span<const unsigned char> bytes) {
  bool first = true;
  for (std::size_t at = 8; at <= bytes.size(); first = false) {
    if (bytes.size() - at < 12) return "the data ends early";
    const std::size_t length = read_u32(bytes, at);
    if (length > bytes.size() - at - 12) return "the data ends early";
    const std::span<const unsigned char> body = bytes.subspan(at + 4, 4 + length);
    const std::string_view type(reinterpret_cast<const char*>(body.data()), 4);
    for (const char c : type) {
      if (std::isalpha(static_cast<unsigned char>(c)) == 0) return "a chunk has no proper name";
    }
    if (first && type != "IHDR") return "it does not start with IHDR";
    const bool critical = std::isupper(static_cast<unsigned char>(type[0])) != 0;
    if (critical && checksum(body) != read_u32(bytes, at + 8 + length)) return "a checksum does not match";
    if (type == "IEND") return nullptr;
    at += 12 + length;
  }
  return "the data ends early";
}

PngHeader read_png_header(std::span<const unsigned char> encoded) {
  constexpr std::size_t kSignature = 8, kChunkHead = 8;
  if (encoded.size() < kSignature + kChunkHead + 8) throw std::runtime_error("broken: the data ends early");
  return {read_u32(encoded, kSignature + kChunkHead), read_u32(encoded, kSignature + kChunkHead + 4)};
}

}  // namespace carousel::scene
