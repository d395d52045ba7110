#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/config/fields/testers.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The rays of a resource that wait for a warp, and the packing of those whose next step is of one kind.
class WarpForming {
 public:
  explicit WarpForming(const SimtConfig& config)
      : lanes_(static_cast<std::size_t>(config.warp)),
        patience_(static_cast<Cycle>(config.wait_cycles)),
        packs_(config.compaction == SimtConfig::Compaction::kRepack),
        packed_per_cycle_(static_cast<std::uint64_t>(config.repack_rays_per_cycle)) {}

  struct Warp {
    std::vector<std::uint32_t> slots;
    Cycle begin = 0;
  };

  /// `leaf`: its next step is at a leaf, which matters where rays are packed.
  void wait(std::uint32_t slot, bool leaf, Cycle now) { queues_[packs_ && leaf].push_back({slot, now}); }
  /// The rays of a warp that can be formed: as many as it has lanes, those of the ray first that waited longest, or
  /// fewer when that ray has waited as long as it may.
  std::optional<Warp> form(Cycle now) {
    std::deque<Waiting>* chosen = nullptr;
    for (std::deque<Waiting>& queue : queues_)
      if (!queue.empty() && (queue.size() >= lanes_ || queue.front().since + patience_ <= now) &&
          (chosen == nullptr || queue.front().since < chosen->front().since))
        chosen = &queue;
    if (chosen == nullptr) return std::nullopt;
    Warp out;
    for (; !chosen->empty() && out.slots.size() < lanes_; chosen->pop_front())
      out.slots.push_back(chosen->front().slot);
    out.begin = now;
    if (!packs_) return out;
    const Cycle cycles = ceil_div(out.slots.size(), packed_per_cycle_);
    free_at_ = std::max(free_at_, now) + cycles;
    packing_ += cycles;
    out.begin = free_at_;
    return out;
  }
  /// The time at which a ray has waited as long as it may.
  Cycle next() const {
    Cycle at = kNever;
    for (const std::deque<Waiting>& queue : queues_)
      if (!queue.empty()) at = std::min(at, queue.front().since + patience_);
    return at;
  }
  bool packs() const { return packs_; }
  std::size_t waiting() const { return queues_[0].size() + queues_[1].size(); }
  Cycle packing() const { return packing_; }  ///< cycles in which rays were packed

 private:
  struct Waiting {
    std::uint32_t slot = 0;
    Cycle since = 0;
  };

  std::size_t lanes_;
  Cycle patience_;
  bool packs_;
  std::uint64_t packed_per_cycle_;
  std::array<std::deque<Waiting>, 2> queues_;  // next at a node, or without packing anywhere; next at a leaf
  Cycle free_at_ = 0, packing_ = 0;
};

}  // namespace carousel::ringbus::cycle
