#pragma once

#include <bit>
#include <cstdint>

#include "core/numeric/rng.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// The random numbers of one case of a certificate: a pure function of seed, property and number.
class CaseRandom {
 public:
  CaseRandom(std::uint64_t seed, std::uint32_t property, std::uint64_t number)
      : key_{seed, property, static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)} {}

  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(std::uint64_t{next()} * n >> 32); }
  float uniform() { return unit_float(next()); }
  float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
  Vec3 in_box(const Vec3& lo, const Vec3& hi) {
    const float x = uniform(lo.x, hi.x), y = uniform(lo.y, hi.y), z = uniform(lo.z, hi.z);
    return {x, y, z};
  }
  /// Any bit pattern: NaN, infinities, denormals, zeros of both signs.
  float any_bits() { return std::bit_cast<float>(next()); }

 private:
  std::uint32_t next() {
    if (drawn_ % 4 == 0) block_ = random_block(key_, drawn_ / 4);
    return block_[drawn_++ % 4];
  }

  RandomKey key_;
  PhiloxCounter block_{};
  std::uint32_t drawn_ = 0;
};

}  // namespace carousel::accel
