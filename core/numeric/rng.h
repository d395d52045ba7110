#pragma once

// Counter-based random numbers: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers:
// as easy as 1, 2, 3", SC 2011. Philox4x32 with 10 rounds; a number is a pure function of its key and
// counter, so it depends neither on the thread nor on the time of the call.

#include <array>
#include <cstdint>

namespace carousel {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// Four random words for one counter.
constexpr PhiloxCounter philox4x32(PhiloxCounter counter, PhiloxKey key) {
  constexpr std::uint64_t kMultiplier0 = 0xd2511f53u, kMultiplier1 = 0xcd9e8d57u;
  constexpr std::uint32_t kWeyl0 = 0x9e3779b9u, kWeyl1 = 0xbb67ae85u;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = kMultiplier0 * counter[0], p1 = kMultiplier1 * counter[2];
    counter = {std::uint32_t(p1 >> 32) ^ counter[1] ^ key[0], std::uint32_t(p1),
               std::uint32_t(p0 >> 32) ^ counter[3] ^ key[1], std::uint32_t(p0)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return counter;
}

/// A float in [0, 1) from the upper 24 bits, every value exactly representable.
constexpr float unit_float(std::uint32_t word) {
  return static_cast<float>(word >> 8) * 0x1p-24f;
}

/// The key of a random number. Decisions are numbered by fixed enumerators (`dimension`), never by a
/// running counter, so an absent decision does not shift the others.
struct RandomKey {
  std::uint64_t seed = 0;
  std::uint32_t pixel = 0, sample = 0, bounce = 0;
};

/// The words of dimensions 4 * block to 4 * block + 3.
constexpr PhiloxCounter random_block(const RandomKey& key, std::uint32_t block) {
  return philox4x32({key.pixel, key.sample, key.bounce, block},
                    {std::uint32_t(key.seed), std::uint32_t(key.seed >> 32)});
}

}  // namespace carousel
