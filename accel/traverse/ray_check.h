#pragma once

#include <cmath>

#include "core/types/ray.h"
#include "core/types/workload.h"

namespace carousel::accel {

/// True if the tests have a meaning for this ray: its origin and direction are finite, its direction is not zero, and
/// 0 <= tmin <= tmax. Invalid rays complete at once as misses.
inline bool valid(const Ray& ray) {
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(ray.origin[a]) || !std::isfinite(ray.direction[a])) return false;
  return (ray.direction.x != 0 || ray.direction.y != 0 || ray.direction.z != 0) && ray.tmin >= 0 &&
         ray.tmin <= ray.tmax;
}

/// The record of a ray that has been tested against nothing yet. A ray that is not valid gets a range that ends
/// before it starts, which every box misses.
inline void start_record(const RayRequest& request, RayRecord& record) {
  record.ray = request.ray;
  record.tag = request.tag;
  record.tag.flags &= kRequestFlags;
  record.hit = Hit{};
  record.hit.t = valid(request.ray) ? request.ray.tmax : -kInfinity;
}

/// Appends a completed record's result for the workload; a miss has one canonical form.
inline void finish_record(const RayRecord& record, HitBatch& out) {
  RayResult& result = out.emplace_back();
  result.ray = record.ray;
  if (record.hit.valid()) result.hit = record.hit;
  result.tag = record.tag;
  result.tag.flags &= kRequestFlags;
}

}  // namespace carousel::accel
