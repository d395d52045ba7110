#pragma once

#include <cstddef>
#include <utility>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"

namespace carousel::ringbus::cycle {

/// A resource's any-hit calls to shader workers and their answers (`testers.any_hit: shader`). Does nothing with
/// `inline`.
class AnyHitPort {
 public:
  AnyHitPort(const LinkConfig& link, const SidePorts& ports)
      : questions_(ports.questions), answers_(ports.answers), wire_(link, control_latency(link)) {}

  /// Sends the calls of a visit, if there are any; `question` is empty afterwards.
  void send(AnyHitQuestion& question, Cycle now) {
    if (question.slots.empty()) return;
    const Cycle arrival = wire_.send(question.bytes(), now);
    questions_->send(arrival, std::move(question));
    ++out_;
    question = {};
  }
  Cycle next() const { return answers_ == nullptr ? kNever : answers_->next(); }
  AnyHitAnswer take() {
    --out_;
    return answers_->take();
  }
  bool on() const { return answers_ != nullptr; }
  std::size_t under_way() const { return out_; }

 private:
  Channel<AnyHitQuestion>* questions_;  // null with `inline`
  Channel<AnyHitAnswer>* answers_;
  SideWire wire_;
  std::size_t out_ = 0;
};

}  // namespace carousel::ringbus::cycle
