#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace carousel::ringbus::stress {

/// The producer of a message, and the message's number among that producer's.
struct Origin {
  std::uint32_t producer = 0, number = 0;
};

/// A finaliser (Stafford's variant 13, as in SplitMix64): every bit of the result depends on every bit of `x`.
constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A message that shows any damage: the first word holds a scrambled 20-bit checksum, 12 bits of producer and 32 of
/// number, and each other word is computed from the first and its own index.
template <std::size_t kBytes>
struct Message {
  static_assert(kBytes % 8 == 0 && kBytes >= 8);
  static constexpr std::size_t kWords = kBytes / 8;
  std::array<std::uint64_t, kWords> words;

  static Message of(Origin origin) {
    Message m;
    const std::uint64_t low = std::uint64_t{origin.producer} << 32 | origin.number;
    m.words[0] = scramble(low) << 44 | low;
    for (std::size_t i = 1; i < kWords; ++i) m.words[i] = follower(m.words[0], i);
    return m;
  }
  /// The origin; empty if any word has changed.
  std::optional<Origin> open() const {
    const std::uint64_t low = words[0] & ((std::uint64_t{1} << 44) - 1);
    std::uint64_t wrong = words[0] ^ (scramble(low) << 44 | low);
    for (std::size_t i = 1; i < kWords; ++i) wrong |= words[i] ^ follower(words[0], i);
    if (wrong != 0) return std::nullopt;
    return Origin{static_cast<std::uint32_t>(low >> 32), static_cast<std::uint32_t>(low)};
  }

 private:
  static std::uint64_t follower(std::uint64_t first, std::size_t i) { return (first + i) * 0x9e3779b97f4a7c15u; }
};

/// The sizes of messages: an index, a cache line, and a packet of 32 ray IDs with its header.
inline constexpr std::size_t kSmall = 8, kLine = 64, kPacket = 256;

}  // namespace carousel::ringbus::stress
