#pragma once

#include "ringbus/cycle/testers/tester.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/time/state_clock.h"

namespace carousel::ringbus::cycle {

/// Accounts a resource's cycles to its states, and within each state those of every bank of its testers, when they have
/// been spent. All of them add up to the run.
class TileLedger {
 public:
  /// Keeps a reference.
  explicit TileLedger(Tester& tester) : tester_(tester) {}

  /// From `now` on the resource is in `state`.
  void enter(TileState state, Cycle now) {
    // Banks keep their busy times until they have been accounted, so this must not be too rare.
    if (state != clock_.state() || now - accounted_ >= 4096) {
      tester_.account(clock_.state(), now);
      accounted_ = now;
    }
    clock_.enter(state, now);
  }
  TileState state() const { return clock_.state(); }
  /// The run is over.
  void close(Cycle end) {
    tester_.account(clock_.state(), end);
    clock_.enter(TileState::kIdle, end);
  }
  /// After close().
  void fill_in(TileResult& result) const {
    result.states = clock_.times();
    tester_.fill_in(result);
  }

 private:
  Tester& tester_;
  Cycle accounted_ = 0;  // the banks' times until then
  StateClock<TileState, kTileStates> clock_;
};

}  // namespace carousel::ringbus::cycle
