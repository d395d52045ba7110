#pragma once

#include <array>
#include <cstddef>

#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// Measures how long something has been in each of its states; the times add up to the whole.
template <class State, std::size_t kStates>
class StateClock {
 public:
  void enter(State state, Cycle now) {
    times_[static_cast<std::size_t>(state_)] += now - since_;
    since_ = now;
    state_ = state;
  }
  State state() const { return state_; }
  /// By state, until the last enter().
  const std::array<Cycle, kStates>& times() const { return times_; }

 private:
  std::array<Cycle, kStates> times_{};
  State state_{};
  Cycle since_ = 0;
};

}  // namespace carousel::ringbus
