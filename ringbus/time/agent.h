#pragma once

#include <string>

#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus {

/// A part of the machine with a clock of its own. Agents meet only through channels whose latency is at least
/// the window's length, so that within a window each can run by itself, on any thread, and nothing depends on
/// which runs first.
class Agent {
 public:
  virtual ~Agent() = default;

  /// Its cycles, and those of the fastest clock of the machine (MachineClocks::to_fastest()). Its own are those of all
  /// that follows here; of its neighbours' channels, those that lead to it tell their times in them.
  const ClockRatio& clock() const { return clock_; }
  /// Before the start; without it, it goes by the fastest clock.
  void run_by(const ClockRatio& clock) { clock_ = clock; }

  /// The next cycle in which it has something to do; kNever until something arrives.
  virtual Cycle next() const = 0;
  /// Tells whether next() may change without an announcement in the WakeupTable; false if its last answer holds until
  /// something is sent on a connected channel.
  virtual bool polled() const { return true; }
  /// The answer of next() if only things that are not announced have changed since the last run.
  virtual Cycle unannounced() const { return next(); }
  /// Something will arrive at `at` on a channel that was connected by WakeupTable::connect_beside(). Called between
  /// windows, before run().
  virtual void notify(Cycle at) { static_cast<void>(at); }
  /// Does everything there is to do before `end`, in the order of time.
  virtual void run(Cycle end) = 0;
  /// The answer of next() as run() has left it. Messages that have arrived since then are announced. An agent that is
  /// polled() may leave out the changes that unannounced() will tell.
  virtual Cycle next_after_run() const { return polled() ? kNever : next(); }
  /// One line that says what it holds and waits for, for the report of a machine that got stuck; empty when it is at
  /// rest.
  virtual std::string describe() const = 0;

 private:
  ClockRatio clock_;
};

}  // namespace carousel::ringbus
