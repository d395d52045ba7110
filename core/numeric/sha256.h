#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace carousel {

/// The 32 bytes of SHA-256 (FIPS 180-4, section 6.2).
std::array<std::uint8_t, 32> sha256(std::string_view bytes);

}  // namespace carousel
