#include "ringbus/cycle/traffic/traffic_node.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

TrafficNode::TrafficNode(ResourceId id, const Topology& topology, const FlowRules& flow,
                         const TrafficNodeSettings& settings, TrafficSource source, std::uint64_t packets,
                         TrafficWindow window, Ports ports)
    : topology_(topology),
      id_(id),
      acks_in_(std::move(ports.acks_in)),
      acks_out_(std::move(ports.acks_out)),
      window_(window),
      inject_cycles_(settings.inject_cycles),
      eject_cycles_(settings.eject_cycles),
      ack_latency_(settings.link_latency),
      flits_(settings.flits),
      places_wanted_(flow.places_to_inject()),
      injects_first_(flow.injects_first()),
      allowances_(acks_in_.size(), {settings.link_depth, {}}),
      passing_acks_(acks_in_.size()) {
  for (std::size_t d = 0; d < ports.in.size(); ++d) ways_.push_back({ports.in[d], std::move(ports.out[d])});
  queues_.assign(settings.shared_queue ? 1 : ways_.size() + 1, {source, packets});
  for (SourceQueue& queue : queues_) {
    create(queue);
    due_ = std::min(due_, queue.due);
  }
}

void TrafficNode::create(SourceQueue& queue) {
  constexpr int kAhead = 64;  // packets of other queues that it reads past before they have been created
  look_at_next(queue);
  for (int i = 0; i < kAhead && queue.waiting && !queue.mine; ++i) look_at_next(queue);
  queue.due = !queue.waiting ? kNever : queue.mine ? queue.ready : queue.source.created();
}

void TrafficNode::look_at_next(SourceQueue& queue) {
  queue.waiting = queue.to_create > 0;
  if (!queue.waiting) return;
  --queue.to_create;
  queue.source.advance();
  const ResourceId to = queue.source.destination();
  queue.route = topology_.route(id_, to, queue.source.random());
  queue.exit = topology_.direct() ? topology_.out_port_to(id_, to) : queue.route.direction;
  queue.mine = queues_.size() == 1 ||
               static_cast<std::size_t>(&queue - queues_.data()) == (queue.route.hops == 0 ? ways_.size() : queue.exit);
  if (!queue.mine) return;
  queue.ready = std::max(queue.source.created() + inject_cycles_, queue.free);
  if (queue.source.created() < window_.begin) return;
  ++offered_;
  routers_ += queue.route.hops + 1u;
}

// ---- time

Cycle TrafficNode::next() const {
  Cycle first = next_here();
  for (const Way& way : ways_)
    if (const Cycle at = way.in.next(); at > now_) first = std::min(first, at);
  return std::min(first, next_ack());
}

Cycle TrafficNode::next_ack() const {
  Cycle first = kNever;
  for (const Channel<TrafficAck>* acks : acks_in_) first = std::min(first, acks->next());
  return first;
}

/// The time at which a packet that is ready may be injected, as far as is known.
[[gnu::always_inline]] inline Cycle TrafficNode::next_injection(const SourceQueue& queue) const {
  if (queue.route.hops == 0) return sink_free_ - (flits_ - 1u);
  if (!allowances_.empty()) {
    const Allowance& allowance = allowances_[queue.route.direction];
    if (allowance.left == 0 && allowance.acks.empty()) return kNever;
    if (allowance.left == 0 && allowance.acks.front() > now_) return allowance.acks.front();
  }
  return ways_[queue.exit].out.opens(places_wanted_);
}

[[gnu::always_inline]] inline Cycle TrafficNode::next_injection() const {
  if (due_ > now_) return due_;
  Cycle first = kNever;
  for (const SourceQueue& queue : queues_)
    first = std::min(first, queue.due > now_ ? queue.due : next_injection(queue));
  return first;
}

Cycle TrafficNode::next_here() const {
  Cycle first = next_injection();
  for (const Way& way : ways_) {
    // An arrival that is not later than the last step waits: for the sink, or for the egress place.
    if (way.arrival > now_)
      first = std::min(first, way.arrival);
    else if (sink_free_ > now_ && way.in.front().skip == 0)
      first = std::min(first, sink_free_);
  }
  if (egress_count_ > 0)
    for (const Way& way : ways_)
      if (!way.out.empty()) first = std::min(first, way.out.next(false));
  return first;
}

/// Tells whether a credit may let it do something that next_here() does not know of.
bool TrafficNode::awaits_credit() const {
  if (egress_count_ > 0 &&
      std::any_of(ways_.begin(), ways_.end(), [](const Way& way) { return way.out.awaits_credit(); }))
    return true;
  return due_ <= now_ && std::any_of(queues_.begin(), queues_.end(), [&](const SourceQueue& queue) {
           return queue.due <= now_ && queue.route.hops > 0 && ways_[queue.exit].out.lacks_credits(places_wanted_);
         });
}

void TrafficNode::run(Cycle end) {
  // Packets that are sent to it from now on arrive after `end`, so it is enough to look once.
  for (Way& way : ways_) way.arrival = way.in.next();
  if (!allowances_.empty()) take_acks(end);
  if (marks_passed_ < 2) pass_marks(end);
  advance(end);
  if (!allowances_.empty()) {
    for (std::size_t a = 0; a < passing_acks_.size(); ++a) forward_acks(a, end);
    next_ = std::min(next_, next_ack());
  }
  awaits_credit_ = awaits_credit();
}

/// Notes what the links have moved when the window of measurement begins, and when it ends.
void TrafficNode::pass_marks(Cycle end) {
  for (; marks_passed_ < 2 && mark(marks_passed_) <= end; ++marks_passed_) {
    advance(mark(marks_passed_));
    for (Way& way : ways_) way.busy[marks_passed_] = way.out.busy(mark(marks_passed_));
  }
}

/// Does all that happens before `end`.
void TrafficNode::advance(Cycle end) {
  for (;;) {
    // run_unhindered() lets packets on their way go before those of the source, and needs a way.
    next_ = injects_first_ || ways_.empty() ? next_here() : run_unhindered(end);
    if (next_ >= end) break;
    now_ = next_;
    if (egress_count_ > 0) send(now_);
    if (injects_first_ && due_ <= now_) inject_all(now_);
    pass_all(now_);
    if (due_ <= now_) inject_all(now_);
  }
}

// ---- packets

void TrafficNode::send(Cycle now) {
  for (Way& way : ways_) {
    if (way.out.empty()) continue;
    way.out.take_credits(now);
    egress_count_ -= way.out.send(now);
  }
}

/// Takes the first packet that comes one way if its place is free, and returns whether it was.
[[gnu::always_inline]] inline bool TrafficNode::pass(Way& way, Cycle now) {
  const bool ends_here = way.in.front().skip == 0, open = !ends_here && way.out.open(now, 1);
  if (ends_here ? !sink_open(now) : !open && !way.out.has_place()) return false;
  TrafficToken token = way.in.take(now);
  way.arrival = way.in.next();
  if (ends_here) {
    const std::size_t d = static_cast<std::size_t>(&way - ways_.data());
    if (!allowances_.empty()) acknowledge(token, d, now);
    deliver(token, now);
    first_in_ = d + 1 < ways_.size() ? d + 1 : 0;  // the others first, the next time
    return true;
  }
  --token.skip;
  if (open) {
    way.out.launch(token, now, token.skip > 0);
  } else {
    way.out.push(token, now, token.skip > 0);
    ++egress_count_;
  }
  return true;
}

/// While nothing waits here but the source, packets that arrive pass, or the source injects one. Does what there is to
/// do before `end`, as far as that goes, and returns next_here().
Cycle TrafficNode::run_unhindered(Cycle end) {
  while (egress_count_ == 0) {
    const Cycle injection = next_injection();
    Way& way = first_way();
    const Cycle at = way.arrival;
    if (at <= now_) break;  // it waits for the sink
    if (std::min(at, injection) >= end) return std::min(at, injection);
    if (at <= injection) {
      if (!pass(way, at)) return at;
      now_ = at - 1;  // in the same cycle, something may arrive on other ways
    } else {
      now_ = injection;
      inject_all(now_);
    }
  }
  return next_here();
}

/// The one of the first arrival. Each in turn has the sink before the others.
TrafficNode::Way& TrafficNode::first_way() {
  Way* first = &ways_[first_in_];
  for (std::size_t i = 1, d = first_in_; i < ways_.size(); ++i) {
    d = d + 1 < ways_.size() ? d + 1 : 0;
    if (ways_[d].arrival < first->arrival) first = &ways_[d];
  }
  return *first;
}

void TrafficNode::pass_all(Cycle now) {
  for (std::size_t i = 0, d = first_in_; i < ways_.size(); ++i, d = d + 1 < ways_.size() ? d + 1 : 0)
    while (ways_[d].arrival <= now && pass(ways_[d], now)) {
    }
}

void TrafficNode::inject_all(Cycle now) {
  due_ = kNever;
  for (SourceQueue& queue : queues_) {
    while (!queue.mine && queue.due <= now) create(queue);
    if (queue.due <= now) inject(queue, now);
    due_ = std::min(due_, queue.due);
  }
}

void TrafficNode::inject(SourceQueue& queue, Cycle now) {
  const std::uint16_t hops = queue.route.hops;
  const TrafficToken token{queue.source.created(), static_cast<std::uint16_t>(id_.value),
                           static_cast<std::uint16_t>(hops == 0 ? 0 : hops - 1), flits_, hops};
  if (hops == 0) {
    const Cycle tail = now + flits_ - 1u;
    if (!sink_open(tail)) return;
    deliver(token, tail);
  } else if (Out& out = ways_[queue.exit].out; injects_first_) {
    if (!out.has_place()) return;
    out.push(token, now, token.skip > 0);
    out.take_credits(now);
    if (!out.send(now)) ++egress_count_;
  } else {
    if (!out.open(now, places_wanted_) || !may_send_more(queue.route.direction, now)) return;
    out.launch(token, now, token.skip > 0);
  }
  queue.free = now + flits_;
  create(queue);
}

void TrafficNode::deliver(const TrafficToken& token, Cycle tail) {
  sink_free_ = tail + flits_;
  last_ = tail + eject_cycles_;  // the sink's packets come one after the other
  ++delivered_;
  if (last_ >= window_.begin && last_ < window_.end) {
    ++accepted_;
    accepted_hops_ += token.hops;
  }
  if (token.created >= window_.begin) latency_.add(last_ - token.created);
}

// ---- acknowledgements

void TrafficNode::take_acks(Cycle end) {
  for (std::size_t a = 0; a < acks_in_.size(); ++a) {
    Channel<TrafficAck>& acks = *acks_in_[a];
    for (Cycle at; (at = acks.next()) < end;) {
      const TrafficAck ack = acks.take();
      if (ack.source == id_.value)
        allowances_[ack.direction].acks.push_back(at);
      else
        passing_acks_[a].push_back({at, ack});
    }
  }
}

void TrafficNode::forward_acks(std::size_t a, Cycle end) {
  Fifo<PassingAck>& passing = passing_acks_[a];
  for (; !passing.empty() && passing.front().at < end; passing.pop_front())
    acks_out_[a]->send(passing.front().at + ack_latency_, passing.front().ack);
}

void TrafficNode::acknowledge(const TrafficToken& token, std::size_t d, Cycle now) {
  const std::size_t a = topology_.ack_direction(d);
  forward_acks(a, now + 1);  // earlier acknowledgements leave earlier
  acks_out_[a]->send(now + ack_latency_, {token.source, static_cast<std::uint16_t>(d)});
}

bool TrafficNode::may_send_more(std::size_t direction, Cycle now) {
  if (allowances_.empty()) return true;
  Allowance& allowance = allowances_[direction];
  for (; !allowance.acks.empty() && allowance.acks.front() <= now; allowance.acks.pop_front()) ++allowance.left;
  if (allowance.left == 0) return false;
  --allowance.left;
  return true;
}

// ---- the end, good or bad

std::string TrafficNode::describe() const {
  std::string text;
  for (const Way& way : ways_)
    if (!way.out.empty())
      text += fmt::format("; a packet of resource {}, {} hops from its destination, waits for a place",
                          way.out.first().source, way.out.first().skip + 1);
  std::uint64_t unread = 0;  // by the queue that has the most before it
  for (const SourceQueue& queue : queues_)
    if (queue.waiting) unread = std::max(unread, queue.to_create + 1);
  if (unread > 0) text += fmt::format("; {} packets wait to get in", unread);
  return text.empty() ? text : fmt::format("resource {}", id_.value) + text;
}

}  // namespace carousel::ringbus::cycle
