#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace carousel {

// What script/soak changes in random tests.

/// Where random numbers start: 1, or CAROUSEL_SEED, so that each round sees something new and a failure can be
/// seen again.
inline std::uint32_t run_seed() {
  const char* seed = std::getenv("CAROUSEL_SEED");
  return seed != nullptr ? static_cast<std::uint32_t>(std::strtoull(seed, nullptr, 10)) : 1u;
}

/// `wanted` times the number in the environment variable `scale`, if it is set.
inline int scaled(int wanted, const char* scale) {
  const char* factor = std::getenv(scale);
  return factor != nullptr ? std::max(1, static_cast<int>(wanted * std::atof(factor))) : wanted;
}

}  // namespace carousel
