#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "ringbus/time/channel.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The requests of a cache to the memory behind it: line numbers, with kWriteLine and kWholeLine. Each leaves at its
/// time; of those that leave at one time the one that was made first leaves first.
class MemoryRequests {
 public:
  /// Keeps a reference to the channel. `in_order`: requests are made in the order in which they leave, so that each can
  /// be sent when it is made.
  MemoryRequests(Channel<std::uint64_t>& channel, Cycle latency, bool in_order)
      : channel_(channel), latency_(latency), in_order_(in_order) {}

  void add(Cycle leaves, std::uint64_t request) {
    if (in_order_)
      send(leaves, request);
    else
      outgoing_.push({leaves, next_turn_++, request});
  }
  /// The time at which the next request leaves that has not been sent.
  Cycle next() const { return outgoing_.empty() ? kNever : outgoing_.top().ready; }
  /// Sends all that leave by `now`.
  void send_due(Cycle now) {
    for (; !outgoing_.empty() && outgoing_.top().ready <= now; outgoing_.pop()) send(now, outgoing_.top().line);
  }
  /// Sends a request past those that wait for their time.
  void send(Cycle leaves, std::uint64_t request) { channel_.send(leaves + latency_, request); }

 private:
  struct Outgoing {
    Cycle ready = 0;
    std::uint64_t turn = 0, line = 0;
    bool operator>(const Outgoing& o) const { return ready != o.ready ? ready > o.ready : turn > o.turn; }
  };

  Channel<std::uint64_t>& channel_;
  Cycle latency_;
  bool in_order_;
  std::priority_queue<Outgoing, std::vector<Outgoing>, std::greater<>> outgoing_;  // empty if they are in order
  std::uint64_t next_turn_ = 0;
};

}  // namespace carousel::ringbus::cycle
