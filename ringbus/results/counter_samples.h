#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace carousel::ringbus {

/// Counters that only grow, read at regular times: at `interval`, 2 * `interval` and so on. When there are `most`
/// readings, every other one is dropped and the interval doubles. So the interval at the end follows from the length of
/// the run alone: parts that were read apart from each other have been read at the same times, and no length has to be
/// known beforehand.
///
/// A reading holds all that happened before its time. The time that something has taken, and the integral of a level
/// over time, are such counters too.
class CounterSamples {
 public:
  using Time = std::uint64_t;

  CounterSamples() = default;
  /// `most`: at least 2; 0: nothing is read.
  CounterSamples(std::size_t most, std::size_t counters, Time interval = 1)
      : most_(most), counters_(counters), interval_(interval), next_(most == 0 ? ~Time{0} : interval) {}

  bool on() const { return most_ > 0; }
  /// Tells whether a reading has to be made before anything happens at `now`.
  bool due(Time now) const { return next_ <= now; }
  /// Calls `read(time, row)` for each of these readings. All that happens before `now` has happened.
  template <class Read>
  void until(Time now, const Read& read) {
    while (next_ <= now) {
      read(next_, new_row());
      if (++taken_ == most_) halve();
      next_ = interval_ * (taken_ + 1);
    }
  }
  /// The run is over at `end`: the last reading, made by `read(end, row)`, holds everything.
  template <class Read>
  void close(Time end, const Read& read) {
    if (!on() || !last_.empty()) return;
    until(end - std::min<Time>(end, 1), read);
    last_.resize(counters_);
    read(end, std::span(last_));
    end_ = std::max(end, taken_ * interval_ + 1);
  }

  // After close().

  Time interval() const { return interval_; }
  /// Not before the end of the run; later if something was left that nobody waited for.
  Time end() const { return end_; }
  /// Adds the growth of a counter within each sample to `sums`. `interval` is the samples' length, a multiple of
  /// interval(), and they cover the time up to end().
  void add_to(std::span<std::uint64_t> sums, Time interval, std::size_t counter) const {
    std::uint64_t before = 0;
    const std::size_t step = interval / interval_;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const std::size_t reading = (i + 1) * step - 1;
      const std::uint64_t at = reading < taken_ ? values_[reading * counters_ + counter] : last_[counter];
      const std::uint64_t value = std::max(before, at);  // counts that were made ahead of time may have been taken back
      sums[i] += value - std::exchange(before, value);
    }
  }

 private:
  std::span<std::uint64_t> new_row() {
    values_.resize((taken_ + 1) * counters_);
    return std::span(values_).subspan(taken_ * counters_);
  }
  void halve() {
    taken_ /= 2;
    for (std::size_t i = 0; i < taken_; ++i)
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>((2 * i + 1) * counters_), counters_,
                  values_.begin() + static_cast<std::ptrdiff_t>(i * counters_));
    interval_ *= 2;
  }

  std::size_t most_ = 0, counters_ = 0, taken_ = 0;
  Time interval_ = 1, next_ = ~Time{0};
  std::vector<std::uint64_t> values_, last_;  // counters_ numbers a reading
  Time end_ = 0;
};

/// The integral of a level over time.
class LevelSum {
 public:
  /// The level has been `level` since the last call, and may change at `now`.
  void hold(CounterSamples::Time now, std::uint64_t level) {
    sum_ += level * (now - since_);
    since_ = now;
  }
  /// Up to `at`, which is not before the last hold(), if the level has been `level` since.
  std::uint64_t at(CounterSamples::Time at, std::uint64_t level) const { return sum_ + level * (at - since_); }

 private:
  std::uint64_t sum_ = 0;
  CounterSamples::Time since_ = 0;
};

/// A level, and its integral over time.
class Level {
 public:
  void change(CounterSamples::Time now, std::int64_t by) {
    sum_.hold(now, level_);
    level_ += static_cast<std::uint64_t>(by);
  }
  void clear(CounterSamples::Time now) { change(now, -static_cast<std::int64_t>(level_)); }
  std::uint64_t at(CounterSamples::Time at) const { return sum_.at(at, level_); }

 private:
  LevelSum sum_;
  std::uint64_t level_ = 0;
};

}  // namespace carousel::ringbus
