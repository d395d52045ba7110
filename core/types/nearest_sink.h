#pragma once

#include <span>

#include "core/types/workload.h"

namespace carousel {

/// Takes the nearest hits of each ray that looks for several (`rays.query.nearest`), when it leaves its slot. A ray
/// that is traced again gives the same hits again. Any thread may call.
class NearestSink {
 public:
  virtual ~NearestSink() = default;
  /// `ray` as shading will get it, with the first of `hits`, or a miss. `hits` are sorted, and valid during the call.
  virtual void add(const RayResult& ray, std::span<const Hit> hits) = 0;
};

}  // namespace carousel
