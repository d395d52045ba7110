#pragma once

#include <cstdint>

#include "core/config/config.h"
#include "core/statistics/link_fault_counts.h"

namespace carousel::ringbus {

/// What happens to one frame.
struct FaultDraw {
  bool drop = false, duplicate = false, corrupt = false, reorder = false, delay = false;
  std::uint64_t bits = 0;  ///< random: where a corrupted frame is hurt
};

/// Draws fates: the n-th frame of a stream has the same one in every run.
class FaultInjector {
 public:
  /// `stream` tells links and directions apart.
  FaultInjector(const FaultsConfig::Links& links, std::int64_t seed, std::uint64_t stream)
      : links_(links), key_(mix(static_cast<std::uint64_t>(seed) * 0x9e3779b97f4a7c15u + stream)) {}

  /// The next frame's; counts what it draws.
  FaultDraw next(LinkFaultCounts& counts) {
    FaultDraw fate;
    fate.drop = happens(links_.drop);
    fate.duplicate = happens(links_.duplicate);
    fate.corrupt = happens(links_.corrupt);
    fate.reorder = happens(links_.reorder);
    fate.delay = happens(links_.delay);
    fate.bits = draw();
    counts.dropped += fate.drop;
    if (fate.drop) return fate;  // the rest cannot be seen
    counts.duplicated += fate.duplicate;
    counts.corrupted += fate.corrupt;
    counts.reordered += fate.reorder;
    counts.delayed += fate.delay;
    return fate;
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
