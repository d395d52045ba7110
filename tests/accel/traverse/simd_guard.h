#pragma once

#include <vector>

#include "accel/traverse/kernels.h"
#include "core/system/error.h"

namespace carousel::accel {

/// Leaves the choice of SIMD target to the machine again.
struct SimdGuard {
  ~SimdGuard() { select_simd_target(SimdTarget::kAuto); }
};

/// The targets this build and machine have, by trying each.
inline std::vector<SimdTarget> usable_simd_targets() {
  const SimdGuard guard;
  std::vector<SimdTarget> usable{SimdTarget::kAuto};
  for (const SimdTarget target :
       {SimdTarget::kScalar, SimdTarget::kSsse3, SimdTarget::kSse4, SimdTarget::kAvx2, SimdTarget::kAvx3}) {
    try {
      select_simd_target(target);
      usable.push_back(target);
    } catch (const ConfigError&) {
    }
  }
  return usable;
}

}  // namespace carousel::accel
