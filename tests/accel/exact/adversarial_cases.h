#pragma once

#include <cstddef>

#include "tests/support/random_runs.h"

namespace carousel::accel {

/// Cases that a randomised test against exact arithmetic tries, all its kinds together.
inline int adversarial_cases() {
  return scaled(200'000);
}

/// Rays in all that are compared with another tracer's.
inline std::size_t oracle_rays() {
  return static_cast<std::size_t>(adversarial_cases());
}

}  // namespace carousel::accel
