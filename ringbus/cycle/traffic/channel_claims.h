#pragma once

#include <cstddef>
#include <vector>

namespace carousel::ringbus::cycle {

/// The virtual channels of all ways out of a node, and the queues whose packets have them. A channel belongs to the
/// packet of one queue from its claim until release().
///
/// Queues that claim in the same cycle are told apart by iSLIP of one iteration (N. McKeown, IEEE/ACM Trans. Networking
/// 7 (1999)): each free channel offers itself to one of the queues that ask for it, by turns, and a queue that gets
/// several offers takes one, by turns. The other offers lapse, so that a queue can come away with nothing though a
/// channel is free. This is the separable allocator of BookSim2's input-queued router.
class ChannelClaims {
 public:
  static constexpr std::size_t kNone = ~std::size_t{0};

  ChannelClaims(std::size_t queues, std::size_t channels)
      : of_(queues, kNone), next_channel_(queues), taken_(channels), next_queue_(channels), offers_(channels, kNone) {}

  bool taken(std::size_t channel) const { return taken_[channel]; }
  /// Tells whether one of the channels from `begin` until before `end` is free.
  bool any_free(std::size_t begin, std::size_t end) const;
  /// The channel of the queue's packet, or kNone.
  std::size_t of(std::size_t queue) const { return of_[queue]; }
  void take(std::size_t queue, std::size_t channel) {
    of_[queue] = channel;
    taken_[channel] = true;
  }
  void release(std::size_t queue) {
    taken_[of_[queue]] = false;
    of_[queue] = kNone;
  }

  /// A queue without a channel asks for one of these; at most once before settle().
  void ask(std::size_t queue, std::size_t begin, std::size_t end) { asking_.push_back({queue, begin, end}); }
  /// Gives channels to those that have asked, and calls `given(queue)` for each that gets one.
  template <class Given>
  void settle(const Given& given) {
    if (asking_.empty()) return;
    offer();
    for (const Asking& one : asking_)
      if (accept(one)) given(one.queue);
    asking_.clear();
  }

 private:
  struct Asking {
    std::size_t queue, begin, end;
  };

  void offer();
  bool accept(const Asking& one);

  std::vector<std::size_t> of_, next_channel_;  // by queue: its channel; the one that goes first
  std::vector<bool> taken_;                     // by channel
  std::vector<std::size_t> next_queue_;         // by channel: the queue that goes first
  std::vector<std::size_t> offers_;             // by channel, while settle() runs: the queue
  std::vector<Asking> asking_;
};

}  // namespace carousel::ringbus::cycle
