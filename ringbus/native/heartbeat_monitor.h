#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <utility>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// Watches the heartbeat of the resource that may stop. It is silent when it has taken no step for some time while its
/// thread has. One thread notes turns, and another one asks.
class HeartbeatMonitor {
 public:
  using Clock = ScheduleClock;
  static constexpr std::chrono::milliseconds kSilence{100};

  /// The thread that plays the resource has had a turn.
  // Relaxed: the watcher only wants to see it change.
  void note_turn() { turns_.store(turns_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }
  /// `beats`: steps of the resource so far. Returns whether it is silent, and sets last_beat().
  bool silent(std::uint64_t beats) {
    if (std::exchange(beats_, beats) != beats || last_beat_ == Clock::time_point{}) last_beat_ = Clock::now();
    // Time in which its thread did not run does not count.
    const std::uint64_t turns = turns_.load(std::memory_order_relaxed);
    if (std::exchange(turns_seen_, turns) == turns) last_beat_ = std::max(last_beat_, Clock::now() - kSilence / 2);
    return Clock::now() - last_beat_ >= kSilence;
  }
  /// The time at which the resource last was not silent.
  Clock::time_point last_beat() const { return last_beat_; }

 private:
  std::atomic<std::uint64_t> turns_{0};
  std::uint64_t turns_seen_ = 0, beats_ = 0;
  Clock::time_point last_beat_{};
};

}  // namespace carousel::ringbus
