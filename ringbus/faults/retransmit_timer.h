#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// Decides for how many turns a sender waits for an acknowledgement before it sends again: twice as many as one takes
/// on average (V. Jacobson, Congestion avoidance and control, SIGCOMM 1988), learnt from frames that were sent only
/// once, and doubled after each wait in vain (P. Karn, C. Partridge, Improving round-trip time estimates, SIGCOMM
/// 1987). Turns are short where threads have cores, and then waiting for a clock's tick would be too long. Where
/// threads wait for cores, each turn takes a time slice in which the other end has had its turn, so few of them are
/// enough.
class RetransmitTimer {
 public:
  using Clock = ScheduleClock;
  /// Frame `sequence` goes on the wire for the first time.
  void sent(std::uint64_t sequence) {
    if (timed_) return;
    timed_ = true;
    timed_sequence_ = sequence;
    timed_since_ = turn_;
  }
  /// All frames before `expected` have been acknowledged.
  void heard(std::uint64_t expected) {
    if (timed_ && expected > timed_sequence_) {
      average_ += (static_cast<double>(turn_ - timed_since_) - average_) / 8;
      timed_ = false;
      factor_ = 1;  // only here: the answer to a frame that was sent twice does not tell how long one takes
    }
    quiet_ = 0;
  }
  /// Frames are sent again.
  void went_back() {
    timed_ = false;
    quiet_ = 0;
  }
  /// Counts a turn in which frames are unacknowledged. Returns true when it is time to send again. Calls `now` for the
  /// time only if it needs it.
  template <class Now>
  bool ends(const Now& now) {
    ++turn_;
    if (++quiet_ == kSlow) slow_at_ = now() + kSlice;
    if (quiet_ < turns() && (quiet_ <= kSlow || now() < slow_at_)) return false;
    went_back();
    factor_ = std::min<std::uint64_t>(2 * factor_, kMost);
    return true;
  }
  std::uint64_t turns() const {
    return std::clamp<std::uint64_t>(factor_ * (static_cast<std::uint64_t>(2 * average_) + 2), kLeast, kMost);
  }

 private:
  // At least so many, as a turn may begin in the middle of one of the other end's. At most so many, as answers that are
  // lost make them seem ever slower.
  static constexpr std::uint64_t kLeast = 4, kMost = 64;
  // If the turns after so many take longer than a slice, cores are short.
  static constexpr std::uint64_t kSlow = 1;
  static constexpr std::chrono::microseconds kSlice{500};

  std::uint64_t turn_ = 0, quiet_ = 0;  // quiet: turns since an answer, or since frames were sent again
  Clock::time_point slow_at_{};
  double average_ = 2;
  std::uint64_t factor_ = 1;
  bool timed_ = false;  // a frame is being timed
  std::uint64_t timed_sequence_ = 0, timed_since_ = 0;
};

}  // namespace carousel::ringbus
