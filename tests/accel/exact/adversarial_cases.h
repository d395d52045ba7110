#pragma once

#include <cstddef>
#include <cstdlib>

namespace carousel::accel {

/// Cases that a randomised test against exact arithmetic tries, all its kinds together; CAROUSEL_ORACLE_RAYS asks for
/// more, as script/soak does.
inline int adversarial_cases() {
  const char* cases = std::getenv("CAROUSEL_ORACLE_RAYS");
  return static_cast<int>(cases != nullptr ? std::atof(cases) : 1e6);
}

/// Rays in all that are compared with another tracer's.
inline std::size_t oracle_rays() {
  return static_cast<std::size_t>(adversarial_cases());
}

}  // namespace carousel::accel
