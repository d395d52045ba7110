#pragma once

#include <atomic>
#include <cstdint>

#include "core/types/vec.h"

namespace carousel::shading {

/// Shading's record of a path while its rays are in flight. At most one of them is a camera or bounce ray; only the
/// worker that shades that one touches the plain members. Shadow rays of several bounces may be shaded by other workers
/// meanwhile, which touch the atomics and read pixel and sample.
struct alignas(64) PathState {
  std::atomic<std::int64_t> radiance[3];      ///< fixed point, so far
  std::atomic<std::uint32_t> outstanding{0};  ///< rays in flight
  std::uint32_t pixel = 0, sample = 0;        ///< pixel = y * width + x
  Vec3 throughput{1};
  float bounce_pdf = 0;    ///< density of the direction of the bounce ray in flight
  float behind = 0;        ///< length of its way before the panes that it has passed since it was scattered
  bool scattered = false;  ///< a bounce went through a wide lobe: see widened_roughness()
};
static_assert(sizeof(PathState) == 64);

}  // namespace carousel::shading
