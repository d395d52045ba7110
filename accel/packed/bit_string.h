#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace carousel::accel {

inline constexpr std::uint32_t kPackedBytes = 128, kPackedBits = 8 * kPackedBytes;

/// The bits of a block of compressed triangles, the lowest of the first word first.
using PackedBits = std::array<std::uint64_t, kPackedBits / 64>;

/// Writes numbers behind one another, and counts on where there is no more room.
class BitWriter {
 public:
  /// The lowest `width` bits of `value`; at most 32.
  void put(std::uint32_t value, unsigned width) {
    for (unsigned i = 0; i < width; ++i, ++at_)
      if (at_ < kPackedBits && (value >> i & 1) != 0) bits_[at_ / 64] |= std::uint64_t{1} << (at_ % 64);
  }
  std::size_t size() const { return at_; }
  const PackedBits& bits() const { return bits_; }

 private:
  PackedBits bits_{};
  std::size_t at_ = 0;
};

/// Reads them again. Behind the end there are zeros.
class BitReader {
 public:
  /// Keeps a reference.
  explicit BitReader(const PackedBits& bits) : bits_(bits) {}
  std::uint32_t take(unsigned width) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < width; ++i, ++at_)
      if (at_ < kPackedBits) value |= static_cast<std::uint32_t>(bits_[at_ / 64] >> (at_ % 64) & 1) << i;
    return value;
  }

 private:
  const PackedBits& bits_;
  std::size_t at_ = 0;
};

}  // namespace carousel::accel
