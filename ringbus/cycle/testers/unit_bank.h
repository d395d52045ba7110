#pragma once

#include <algorithm>
#include <cstddef>

#include "core/config/fields/testers.h"
#include "core/numeric/divisor.h"
#include "ringbus/results/slice_log.h"
#include "ringbus/time/clock.h"
#include "ringbus/time/fifo.h"

namespace carousel::ringbus::cycle {

/// Equal units side by side: each starts a test every `interval` cycles and answers `latency` cycles later.
class UnitBank {
 public:
  UnitBank() : UnitBank(TesterUnits{}) {}
  explicit UnitBank(const TesterUnits& config)
      : units_(static_cast<Cycle>(config.units)),
        interval_(static_cast<Cycle>(config.interval_cycles)),
        latency_(static_cast<Cycle>(config.latency_cycles)) {}

  struct Reservation {
    Cycle first = 0;  ///< the first answer
    Cycle last = 0;   ///< the last one
  };
  /// Takes the bank for `tests`, as soon as it is free but not before `at`. No tests take no time.
  Reservation reserve(Cycle at, std::uint64_t tests) {
    if (tests == 0) return {at, at};
    const Cycle start = std::max(at, free_at_), starts = units_.ceiling(tests), length = starts * interval_;
    if (start > free_at_) {
      if (free_at_ > begun_) spans_.push_back({begun_, free_at_});
      begun_ = start;
    }
    free_at_ = start + length;
    busy_ += length;
    tests_ += tests;
    spare_ = starts * units_.value() - tests;
    return {start + latency_, free_at_ - interval_ + latency_};
  }
  /// As reserve(), but units that the previous tests leave idle in their last cycle are taken first, since single rays
  /// bring too few tests to fill a bank.
  Reservation reserve_beside(Cycle at, std::uint64_t tests) {
    const Cycle last_start = free_at_ - interval_;
    if (tests == 0 || spare_ == 0 || at > last_start) return reserve(at, tests);
    const std::uint64_t beside = std::min(tests, spare_);
    spare_ -= beside;
    tests_ += beside;
    const Cycle first = last_start + latency_;
    return beside == tests ? Reservation{first, first} : Reservation{first, reserve(at, tests - beside).last};
  }

  /// Cycles before `now` in which a test was started or could not be. Times of calls must not decrease.
  Cycle busy_before(Cycle now) {
    for (; !spans_.empty() && spans_.front().end <= now; spans_.pop_front()) {
      past_ += spans_.front().end - spans_.front().begin;
      if (slices_ != nullptr) [[unlikely]]
        slices_->add({.begin = spans_.front().begin, .end = spans_.front().end, .track = track_});
    }
    const Span next = spans_.empty() ? Span{begun_, free_at_} : spans_.front();
    return past_ + (now > next.begin ? std::min(now, next.end) - next.begin : 0);
  }

  /// From now on the spans of time in which it is busy are noted: those that busy_before() has passed, and the rest at
  /// the end of the run.
  void record(SliceLog& slices, std::uint32_t track) {
    slices_ = &slices;
    track_ = track;
  }
  void close(Cycle end) {
    busy_before(end);
    const Span last = spans_.empty() ? Span{begun_, free_at_} : spans_.front();
    if (slices_ != nullptr && last.begin < std::min(last.end, end))
      slices_->add({.begin = last.begin, .end = std::min(last.end, end), .track = track_});
  }

  /// Busy times that busy_before() has not passed, in their order; the last one may grow.
  struct Span {
    Cycle begin = 0, end = 0;
  };
  bool has_span(std::size_t i) const { return i < spans_.size() + (free_at_ > begun_ ? 1 : 0); }
  Span span(std::size_t i) const { return i < spans_.size() ? spans_[i] : Span{begun_, free_at_}; }
  bool works_before(Cycle now) const { return (spans_.empty() ? begun_ : spans_.front().begin) < now && has_span(0); }

  Cycle latency() const { return latency_; }
  Cycle interval() const { return interval_; }
  /// The time of so many tests of which each is started after the one before by an interval, however many units there
  /// are.
  Cycle chain(std::uint64_t tests) const {
    return tests == 0 ? 0 : latency_ + (static_cast<Cycle>(tests) - 1) * interval_;
  }
  Cycle free_at() const { return free_at_; }  ///< the first cycle in which a test may start
  Cycle busy() const { return busy_; }        ///< cycles taken over all time, as far as tests have been reserved
  /// Cycles of all units together that the tests took: at most busy() times the units.
  Cycle worked() const { return tests_ * interval_; }
  Cycle units() const { return units_.value(); }
  std::uint64_t tests() const { return tests_; }

 private:
  Divisor units_;
  Cycle interval_, latency_;
  Cycle free_at_ = 0, busy_ = 0;
  std::uint64_t tests_ = 0, spare_ = 0;  // spare: units left idle when the last tests started
  // For busy_before(): busy times that may end in the future, of which [begun_, free_at_) is the last.
  Fifo<Span> spans_;
  Cycle begun_ = 0, past_ = 0;
  SliceLog* slices_ = nullptr;
  std::uint32_t track_ = 0;
};

}  // namespace carousel::ringbus::cycle
