#pragma once

#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

#include "ringbus/time/agent.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus {

/// Announcements of arrivals, so that no thread has to look into every channel before every window: for each pair of
/// threads, the earliest arrival that the one has sent to each agent of the other. A row is written by its sending
/// thread within a window, and read and cleared by its receiving thread between windows (windows.h); no two threads
/// use it at the same time.
///
/// An agent with many channels may have some of them connected beside the others: it hears of their arrivals apart
/// (Agent::notify), and need not look into them while it has heard nothing.
class WakeupTable {
 public:
  /// Agents by thread, as run_windows() gets them.
  explicit WakeupTable(std::span<const std::vector<Agent*>> parts)
      : threads_(parts.size()), rows_(threads_ * threads_), beside_(threads_ * threads_) {
    for (std::size_t t = 0; t < threads_; ++t) {
      for (std::size_t i = 0; i < parts[t].size(); ++i) places_[parts[t][i]] = {t, i};
      for (std::size_t from = 0; from < threads_; ++from) row(t, from).assign(parts[t].size(), kNever);
    }
  }

  /// From now on the channel announces to agent `to` what agent `from` sends. Needed for every channel to an agent that
  /// is not polled().
  void connect(AnyChannel& channel, const Agent& from, const Agent& to) {
    const Place place = places_.at(&to);
    channel.wakes(row(place.thread, places_.at(&from).thread)[place.index]);
  }
  /// As connect(), for a channel of which `to` is told by Agent::notify().
  void connect_beside(AnyChannel& channel, const Agent& from, const Agent& to) {
    const Place place = places_.at(&to);
    const std::size_t from_thread = places_.at(&from).thread;
    std::vector<Cycle>& beside = row_beside(place.thread, from_thread);
    beside.resize(row(place.thread, from_thread).size(), kNever);
    channel.wakes(beside[place.index]);
  }
  /// By agent of thread `to`.
  std::vector<Cycle>& row(std::size_t to, std::size_t from) { return rows_[to * threads_ + from]; }
  /// As row(), for connect_beside(); empty if no channel is connected so.
  std::vector<Cycle>& row_beside(std::size_t to, std::size_t from) { return beside_[to * threads_ + from]; }

 private:
  struct Place {
    std::size_t thread = 0, index = 0;
  };
  std::size_t threads_;
  std::vector<std::vector<Cycle>> rows_, beside_;
  std::unordered_map<const Agent*, Place> places_;
};

}  // namespace carousel::ringbus
