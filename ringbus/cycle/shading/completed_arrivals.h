#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The order in which completed rays arrive from the resources. A run asks all resources at most once, as most have
/// sent nothing: those that arrive in the present window are kept by time, for the others the earliest time is enough.
class CompletedArrivals {
 public:
  /// By resource, of which those without channels are of other pools; keeps a reference.
  explicit CompletedArrivals(const std::vector<SidePorts>& clients) : clients_(clients) {}

  /// Completed rays have been sent, and arrive in cycle `at`.
  void announce(Cycle at) { beyond_ = std::min(beyond_, at); }
  /// The agent runs up to `end`.
  void open_window(Cycle end) {
    window_end_ = end;
    if (beyond_ >= end) return;
    beyond_ = kNever;
    for (std::uint32_t r = 0; r < clients_.size(); ++r)
      if (clients_[r].completed != nullptr) look_for(r);
  }
  /// The next arrival, as far as it is known.
  Cycle next() const { return due_.empty() ? beyond_ : due_.top().at; }
  /// The next arrival of all that have been sent.
  Cycle next_of_all() const {
    Cycle first = kNever;
    for (const SidePorts& client : clients_)
      if (client.completed != nullptr) first = std::min(first, client.completed->next());
    return first;
  }
  /// Calls `take(resource, message)` for all that have arrived.
  template <class Take>
  void take(Cycle now, Take&& take) {
    while (!due_.empty() && due_.top().at <= now) {
      const std::uint32_t r = due_.top().from;
      due_.pop();
      while (clients_[r].completed->next() <= now) take(r, clients_[r].completed->take());
      look_for(r);
    }
  }

 private:
  struct Due {
    Cycle at = 0;
    std::uint32_t from = 0;
    bool operator>(const Due& o) const { return at != o.at ? at > o.at : from > o.from; }
  };

  void look_for(std::uint32_t client) {
    const Cycle at = clients_[client].completed->next();
    if (at < window_end_)
      due_.push({at, client});
    else
      beyond_ = std::min(beyond_, at);
  }

  const std::vector<SidePorts>& clients_;
  std::priority_queue<Due, std::vector<Due>, std::greater<>> due_;
  Cycle window_end_ = 0, beyond_ = kNever;
};

}  // namespace carousel::ringbus::cycle
