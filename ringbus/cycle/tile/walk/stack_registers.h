#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/types/ids.h"
#include "ringbus/cycle/shapes/shape_port.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"

namespace carousel::ringbus::cycle {

/// The registers that hold the newest entries of each ray's stack, and the simulated memory that holds the others,
/// beyond all shapes. A ray writes what its registers do not hold, which nothing waits for, and reads back half of what
/// they hold when they are empty, which it waits for.
class StackRegisters {
 public:
  /// With 0 entries all have room. Keeps a reference.
  StackRegisters(ResourceId resource, std::int64_t entries, std::uint32_t slots, ShapePort& port)
      : base_((resource.value + std::uint64_t{1}) << 40),
        entries_(entries > 0 ? static_cast<std::size_t>(entries) : ~std::size_t{0}),
        port_(port),
        beyond_(slots, 0) {}

  /// The entries of this ray that are in memory.
  std::size_t beyond(std::uint32_t slot) const { return beyond_[slot]; }
  /// The ray has taken entries from its stack, or dropped all.
  void shrink(std::uint32_t slot, const RayWalk& walk) { beyond_[slot] = std::min(beyond_[slot], walk.entries()); }
  /// The ray has put entries onto its stack.
  void spill(std::uint32_t slot, const RayWalk& walk, Cycle now) {
    const std::size_t held = walk.entries() - beyond_[slot];
    if (held <= entries_) return;
    const std::size_t first = beyond_[slot], last = first + held - entries_;
    const ShapeSpan span = span_of(slot, walk, first, last);
    port_.write(span, now);
    spilled_ += span.bytes;
    beyond_[slot] = last;
  }
  /// Asks for entries; take() when they have come.
  void refill(std::uint32_t slot, const RayWalk& walk, Cycle now) {
    const ShapeSpan span = span_of(slot, walk, first_of_refill(slot), beyond_[slot]);
    port_.request(span, kSpillTag | slot, now);
    refilled_ += span.bytes;
    ++under_way_;
  }
  void take(std::uint32_t slot) {
    beyond_[slot] = first_of_refill(slot);
    --under_way_;
  }
  /// Bytes of the entries in registers.
  std::uint64_t held_bytes(std::uint32_t slot, const RayWalk& walk) const {
    return walk.bytes_of(beyond_[slot], walk.entries());
  }
  bool idle() const { return under_way_ == 0; }
  std::uint64_t spilled_bytes() const { return spilled_; }
  std::uint64_t refilled_bytes() const { return refilled_; }

 private:
  /// More than the stack of a ray that goes depth first can have: 7 entries of 12 bytes a level. Where lanes help, a
  /// ray goes down several ways at once. If its stack has more than this room, it shares addresses with that of the
  /// next slot, which changes what a cache holds, and no hit.
  static constexpr std::uint64_t kRoom = 1 << 14;

  std::size_t first_of_refill(std::uint32_t slot) const {
    return beyond_[slot] - std::min(beyond_[slot], (entries_ + 1) / 2);
  }
  ShapeSpan span_of(std::uint32_t slot, const RayWalk& walk, std::size_t first, std::size_t last) const {
    return {base_ + slot * kRoom + walk.bytes_of(0, first), static_cast<std::uint32_t>(walk.bytes_of(first, last))};
  }

  std::uint64_t base_;
  std::size_t entries_;
  ShapePort& port_;
  std::vector<std::size_t> beyond_;  // by slot
  std::size_t under_way_ = 0;
  std::uint64_t spilled_ = 0, refilled_ = 0;
};

}  // namespace carousel::ringbus::cycle
