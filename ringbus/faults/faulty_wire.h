#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "ringbus/faults/fault_injector.h"

namespace carousel::ringbus {

/// The sending end of a queue that loses, doubles, damages, delays and reorders what is put into it. One thread's.
/// Frame has flip(random) to be damaged by, copy() to be doubled by, and drop() to be lost by.
template <class Queue, class LinkFrame>
class FaultyWire {
 public:
  using Clock = std::chrono::steady_clock;

  FaultyWire(Queue& queue, const FaultInjector& injector, std::chrono::nanoseconds delay)
      : queue_(queue), injector_(injector), delay_(delay) {}
  ~FaultyWire() {
    for (LinkFrame& one : after_next_) one.drop();
    for (Late& one : late_) one.frame.drop();
  }
  FaultyWire(const FaultyWire&) = delete;
  FaultyWire& operator=(const FaultyWire&) = delete;

  bool has_room() { return queue_.free_places() > 1; }  // one may come twice

  /// Takes the frame, which is the wire's from then on.
  void put(LinkFrame frame) {
    const FaultDraw fate = injector_.next(counts_);
    if (fate.drop) {
      frame.drop();
    } else {
      if (fate.corrupt) frame.flip(fate.bits);
      if (fate.duplicate) send(frame.copy());
      if (fate.delay) {
        late_.push_back({Clock::now() + delay_, frame});
      } else if (fate.reorder) {
        after_next_.push_back(frame);
        return;  // the next one goes first
      } else {
        send(frame);
      }
    }
    for (const LinkFrame& one : after_next_) send(one);
    after_next_.clear();
  }
  /// Lets go of what has been late long enough, and of what waits for a next one that may not come.
  void release() {
    if (!after_next_.empty() && ++quiet_ > 8) {
      for (const LinkFrame& one : after_next_) send(one);
      after_next_.clear();
      quiet_ = 0;
    }
    if (late_.empty()) return;
    const Clock::time_point now = Clock::now();
    std::erase_if(late_, [&](const Late& one) {
      if (one.due > now) return false;
      send(one.frame);
      return true;
    });
  }
  const LinkFaultCounts& counts() const { return counts_; }

 private:
  struct Late {
    Clock::time_point due;
    LinkFrame frame;
  };
  // A full queue loses it, as one more fault of the wire.
  void send(LinkFrame frame) {
    if (queue_.try_push(frame)) return;
    ++counts_.dropped;
    frame.drop();
  }

  Queue& queue_;
  FaultInjector injector_;
  std::chrono::nanoseconds delay_;
  std::vector<LinkFrame> after_next_;
  int quiet_ = 0;  // releases since something waits for a next one
  std::vector<Late> late_;
  LinkFaultCounts counts_;
};

}  // namespace carousel::ringbus
