#include "core/numeric/rng.h"

#include <array>
#include <set>

#include <gtest/gtest.h>

namespace carousel {
namespace {

// The known-answer vectors that the authors publish with Random123 (kat_vectors, philox4x32 10).
TEST(Philox, MatchesThePublishedVectors) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (PhiloxCounter{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}));
  EXPECT_EQ(philox4x32({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (PhiloxCounter{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}));
  EXPECT_EQ(philox4x32({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}),
            (PhiloxCounter{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}));
}

TEST(Philox, EveryPartOfTheKeyChangesTheWords) {
  std::set<std::uint32_t> seen;
  for (const RandomKey& key :
       {RandomKey{1, 2, 3, 4}, RandomKey{2, 2, 3, 4}, RandomKey{1 | std::uint64_t{1} << 32, 2, 3, 4},
        RandomKey{1, 3, 3, 4}, RandomKey{1, 2, 4, 4}, RandomKey{1, 2, 3, 5}})
    for (const std::uint32_t block : {1u, 2u})
      for (const std::uint32_t word : random_block(key, block)) seen.insert(word);
  EXPECT_EQ(seen.size(), 6u * 2 * 4);
}

TEST(UnitFloat, CoversTheHalfOpenUnitInterval) {
  EXPECT_EQ(unit_float(0), 0.0f);
  EXPECT_EQ(unit_float(0xffffffffu), 1.0f - 0x1p-24f);
  EXPECT_EQ(unit_float(0x80000000u), 0.5f);
}

TEST(UnitFloat, IsEvenlySpread) {
  std::array<int, 16> bins{};
  for (std::uint32_t i = 0; i < 16000; ++i) {
    for (const std::uint32_t word : random_block({3, i, 0, 0}, 0)) ++bins[std::size_t(unit_float(word) * 16)];
  }
  for (const int count : bins) EXPECT_NEAR(count, 4000, 5 * 63);  // 5 standard deviations
}

}  // namespace
}  // namespace carousel
