#pragma once

#include <chrono>
#include <cstdint>

namespace carousel::ringbus {

/// Whether all threads together run a machine faster than one of them alone. That depends on the host: threads that
/// must wait for each other twice a window are many times slower than one, if other programs use the cores too.
/// Both ways are measured, by the calling thread's own share of the work, which is the same work in both. A trial of
/// the other way takes an interval of windows, and at most a sixteenth of the time.
///
/// One thread uses it. It decides about time alone, never about results.
class FasterWay {
 public:
  using Time = std::chrono::nanoseconds;

  /// An interval that ends at `now` took `took`, in which the caller's share had `runs` runs of agents. Returns
  /// whether one thread is to run the next interval.
  bool alone_after_together(std::uint64_t runs, Time took, Time now) {
    return note(together_, runs, took, now) && (due(alone_, now) || faster(alone_, together_));
  }
  bool alone_after_alone(std::uint64_t runs, Time took, Time now) {
    return !note(alone_, runs, took, now) || (!due(together_, now) && faster(alone_, together_));
  }

 private:
  struct Way {
    double time_per_run = 0;  ///< nanoseconds; 0: never measured
    Time next_trial{0};
  };

  static constexpr int kTrials = 16;        // a trial has a sixteenth of the time at most
  static constexpr double kClearly = 1.25;  // below that the measured difference may be chance

  static bool note(Way& way, std::uint64_t runs, Time took, Time now) {
    if (runs == 0) return false;
    way.time_per_run = static_cast<double>(took.count()) / static_cast<double>(runs);
    way.next_trial = now + kTrials * took;
    return true;
  }
  static bool due(const Way& way, Time now) { return now >= way.next_trial; }
  static bool faster(const Way& way, const Way& other) { return way.time_per_run * kClearly < other.time_per_run; }

  Way together_, alone_;
};

}  // namespace carousel::ringbus
