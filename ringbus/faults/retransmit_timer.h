#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace carousel::ringbus {

/// For how many turns a sender waits for an acknowledgement before it sends again: twice what one takes on average
/// (V. Jacobson, Congestion avoidance and control, SIGCOMM 1988), learnt from frames that were sent once only, and
/// doubled each time it was in vain (P. Karn, C. Partridge, Improving round-trip time estimates, SIGCOMM 1987). Turns
/// are short where threads have cores, and then there is no need to wait for so much as a clock's tick. Where threads
/// wait for cores each turn takes a time slice in which the other end will have had its turn, so few of them are
/// enough.
class RetransmitTimer {
 public:
  using Clock = std::chrono::steady_clock;
  /// Frame `sequence` goes on the wire for the first time.
  void sent(std::uint64_t sequence) {
    if (timed_) return;
    timed_ = true;
    timed_sequence_ = sequence;
    timed_since_ = turn_;
  }
  /// Something was acknowledged: all before `expected`.
  void heard(std::uint64_t expected) {
    if (timed_ && expected > timed_sequence_) {
      average_ += (static_cast<double>(turn_ - timed_since_) - average_) / 8;
      timed_ = false;
      factor_ = 1;  // not for less: an answer to what was sent twice does not say how long one takes
    }
    quiet_ = 0;
  }
  /// Frames are sent again, for whatever reason.
  void went_back() {
    timed_ = false;
    quiet_ = 0;
  }
  /// A turn in which something is out has passed. Whether it is time to send again. `now` tells the time when asked.
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
  // A turn may find the other end in the middle of one. Where answers are lost, too, they seem to take ever longer.
  static constexpr std::uint64_t kLeast = 4, kMost = 64;
  // If, after so many turns, the others take longer than this, cores are short.
  static constexpr std::uint64_t kSlow = 1;
  static constexpr std::chrono::microseconds kSlice{500};

  std::uint64_t turn_ = 0, quiet_ = 0;  // quiet: since something was heard, or sent again
  Clock::time_point slow_at_{};
  double average_ = 2;
  std::uint64_t factor_ = 1;
  bool timed_ = false;  // the frame that is being timed, and since when
  std::uint64_t timed_sequence_ = 0, timed_since_ = 0;
};

}  // namespace carousel::ringbus
