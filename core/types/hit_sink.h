#pragma once

#include <cstdint>

#include "core/types/ray.h"

namespace carousel {

/// Takes every hit of the rays with kRayAll. Tests may report a hit more than once: with the same bits each time.
/// Any thread may call.
class HitSink {
 public:
  virtual ~HitSink() = default;
  /// `path` is the ray's, which names it.
  virtual void add(std::uint32_t path, const Hit& hit) = 0;
};

}  // namespace carousel
