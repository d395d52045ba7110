#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "ringbus/faults/fault_injector.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// The sending end of a queue that loses, doubles, damages, delays and reorders the frames put into it. One thread uses
/// it. A frame has flip(random), which damages it, copy(), and drop(), which releases what it owns.
template <class Queue, class LinkFrame>
class FaultyWire {
 public:
  using Clock = ScheduleClock;

  FaultyWire(Queue& queue, const FaultInjector& injector, std::chrono::nanoseconds delay)
      : queue_(queue), injector_(injector), delay_(delay) {}
  ~FaultyWire() {
    for (LinkFrame& one : after_next_) one.drop();
    for (Late& one : late_) one.frame.drop();
  }
  FaultyWire(const FaultyWire&) = delete;
  FaultyWire& operator=(const FaultyWire&) = delete;

  bool has_room() { return queue_.free_places() > 1; }  // a frame may be sent twice

  /// Takes over the frame.
  void put(LinkFrame frame) {
    const FaultDraw faults = injector_.next(counts_);
    if (faults.drop) {
      frame.drop();
    } else {
      if (faults.corrupt) frame.flip(faults.bits);
      if (faults.duplicate) send(frame.copy());
      if (faults.delay) {
        late_.push_back({Clock::now() + delay_, frame});
      } else if (faults.reorder) {
        after_next_.push_back(frame);
        return;  // the next one goes first
      } else {
        send(frame);
      }
    }
    for (const LinkFrame& one : after_next_) send(one);
    after_next_.clear();
  }
  /// Sends the delayed frames that are due, and frames that wait to be overtaken by a next one that does not come.
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
  // A full queue loses the frame, as one more fault of the wire.
  void send(LinkFrame frame) {
    if (queue_.try_push(frame)) return;
    ++counts_.dropped;
    frame.drop();
  }

  Queue& queue_;
  FaultInjector injector_;
  std::chrono::nanoseconds delay_;
  std::vector<LinkFrame> after_next_;
  int quiet_ = 0;  // calls of release() since a frame waits to be overtaken
  std::vector<Late> late_;
  LinkFaultCounts counts_;
};

}  // namespace carousel::ringbus
