#pragma once

#include <cstdint>

#include "core/config/fields/faults.h"
#include "core/statistics/link_fault_counts.h"

namespace carousel::ringbus {

/// The faults that befall one frame.
struct FaultDraw {
  bool drop = false, duplicate = false, corrupt = false, reorder = false, delay = false;
  std::uint64_t bits = 0;  ///< random: says which bit of a corrupted frame is flipped
};

/// Draws the faults of frames: the n-th frame of a stream has the same ones in every run.
class FaultInjector {
 public:
  /// Links and directions have streams of their own.
  FaultInjector(const FaultsConfig::Links& links, std::int64_t seed, std::uint64_t stream)
      : links_(links), key_(mix(static_cast<std::uint64_t>(seed) * 0x9e3779b97f4a7c15u + stream)) {}

  /// Draws and counts the next frame's faults.
  FaultDraw next(LinkFaultCounts& counts) {
    FaultDraw faults;
    faults.drop = happens(links_.drop);
    faults.duplicate = happens(links_.duplicate);
    faults.corrupt = happens(links_.corrupt);
    faults.reorder = happens(links_.reorder);
    faults.delay = happens(links_.delay);
    faults.bits = draw();
    counts.dropped += faults.drop;
    if (faults.drop) return faults;  // a lost frame shows no other fault
    counts.duplicated += faults.duplicate;
    counts.corrupted += faults.corrupt;
    counts.reordered += faults.reorder;
    counts.delayed += faults.delay;
    return faults;
  }

 private:
  // SplitMix64 (Steele, Lea, Flood 2014): counter-based, one stream a key.
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t draw() { return mix(key_ + 0x9e3779b97f4a7c15u * ++drawn_); }
  bool happens(double fraction) { return static_cast<double>(draw() >> 11) * 0x1p-53 < fraction; }

  FaultsConfig::Links links_;
  std::uint64_t key_, drawn_ = 0;
};

}  // namespace carousel::ringbus
