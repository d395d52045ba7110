#pragma once

#include <cstdint>

#include "accel/structure/accel.h"
#include "core/config/config.h"

namespace carousel::ringbus {

/// An upper bound on the bytes that a run takes: those set aside at the start, and the most that collections may grow
/// to.
struct MemoryEstimate {
  std::uint64_t ray_store = 0;   ///< records and free lists
  std::uint64_t ray_stacks = 0;  ///< ordered traversal and independent resources; mostly untouched
  std::uint64_t collections = 0;
  std::uint64_t packets = 0;
  std::uint64_t rays_waiting = 0;  ///< new rays not yet in slots, completed ones not yet shaded

  std::uint64_t worker_caches = 0;  ///< names of what caches and TLBs of shader workers hold

  std::uint64_t total() const { return ray_store + ray_stacks + collections + packets + rays_waiting + worker_caches; }
};

/// `max_depth` is that of the structure (Accel::max_depth). Rays blend `gaussians` and do not keep what they have met.
MemoryEstimate estimate_memory(const Config& config, int max_depth, bool gaussians = false);

}  // namespace carousel::ringbus
