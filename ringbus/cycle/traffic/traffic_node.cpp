#include "ringbus/cycle/traffic/traffic_node.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

TrafficNode::TrafficNode(ResourceId id, const Topology& topology, const FlowRules& flow,
                         const TrafficNodeSettings& settings, TrafficSource source, std::uint64_t packets,
                         TrafficWindow window, Ports ports)
    : topology_(topology),
      id_(id),
      ports_(std::move(ports)),
      window_(window),
      inject_cycles_(settings.inject_cycles),
      eject_cycles_(settings.eject_cycles),
      ack_latency_(settings.link_latency),
      flits_(settings.flits),
      places_wanted_(flow.places_to_inject()),
      arrivals_(ports_.in.size()),
      injects_first_(flow.injects_first()),
      allowances_(ports_.acks_in.size(), {settings.link_depth, {}}),
      passing_acks_(ports_.acks_in.size()) {
  queues_.assign(settings.shared_queue ? 1 : ports_.out.size() + 1, {std::move(source), packets});
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
  queue.mine = queues_.size() == 1 || static_cast<std::size_t>(&queue - queues_.data()) ==
                                          (queue.route.hops == 0 ? ports_.out.size() : queue.exit);
  if (!queue.mine) return;
  queue.ready = std::max(queue.source.created() + inject_cycles_, queue.free);
  if (queue.source.created() < window_.begin) return;
  ++offered_;
  routers_ += queue.route.hops + 1u;
}

// ---- time

Cycle TrafficNode::next() const {
  Cycle first = next_here();
  for (const In& in : ports_.in)
    if (const Cycle at = in.next(); at > now_) first = std::min(first, at);
  return std::min(first, next_ack());
}

Cycle TrafficNode::next_ack() const {
  Cycle first = kNever;
  for (const Channel<TrafficAck>* acks : ports_.acks_in) first = std::min(first, acks->next());
  return first;
}

Cycle TrafficNode::next_here() const {
  Cycle first = due_ > now_ ? due_ : next_injection();
  for (std::size_t d = 0; d < arrivals_.size(); ++d) {
    // An arrival that is not later than the last step waits: for the sink, or for the egress place.
    if (arrivals_[d] > now_)
      first = std::min(first, arrivals_[d]);
    else if (sink_free_ > now_ && ports_.in[d].front().skip == 0)
      first = std::min(first, sink_free_);
  }
  if (egress_count_ > 0)
    for (const Out& out : ports_.out)
      if (!out.empty()) first = std::min(first, out.next(false));
  return first;
}

Cycle TrafficNode::next_injection() const {
  Cycle first = kNever;
  for (const SourceQueue& queue : queues_)
    first = std::min(first, queue.due > now_ ? queue.due : next_injection(queue));
  return first;
}

/// Of a packet that is ready.
Cycle TrafficNode::next_injection(const SourceQueue& queue) const {
  if (queue.route.hops == 0) return sink_free_ - (flits_ - 1u);
  if (!allowances_.empty()) {
    const Allowance& allowance = allowances_[queue.route.direction];
    if (allowance.left == 0 && allowance.acks.empty()) return kNever;
    if (allowance.left == 0 && allowance.acks.front() > now_) return allowance.acks.front();
  }
  return ports_.out[queue.exit].opens(places_wanted_);
}

/// Tells whether a credit may let it do something that next_here() does not know of.
bool TrafficNode::awaits_credit() const {
  if (egress_count_ > 0 &&
      std::any_of(ports_.out.begin(), ports_.out.end(), [](const Out& out) { return out.awaits_credit(); }))
    return true;
  return due_ <= now_ && std::any_of(queues_.begin(), queues_.end(), [&](const SourceQueue& queue) {
           return queue.due <= now_ && queue.route.hops > 0 && ports_.out[queue.exit].lacks_credits(places_wanted_);
         });
}

void TrafficNode::run(Cycle end) {
  // Packets that are sent to it from now on arrive after `end`, so it is enough to look once.
  for (std::size_t d = 0; d < arrivals_.size(); ++d) arrivals_[d] = ports_.in[d].next();
  if (!allowances_.empty()) take_acks(end);
  for (;;) {
    next_ = injects_first_ ? next_here() : run_unhindered(end);
    if (next_ >= end) break;
    now_ = next_;
    if (egress_count_ > 0) send(now_);
    if (injects_first_ && due_ <= now_) inject_all(now_);
    pass_all(now_);
    if (due_ <= now_) inject_all(now_);
  }
  if (!allowances_.empty()) {
    for (std::size_t a = 0; a < passing_acks_.size(); ++a) forward_acks(a, end);
    next_ = std::min(next_, next_ack());
  }
  awaits_credit_ = awaits_credit();
}

// ---- packets

void TrafficNode::send(Cycle now) {
  for (Out& out : ports_.out) {
    if (out.empty()) continue;
    out.take_credits(now);
    egress_count_ -= out.send(now);
  }
}

/// Takes the first packet of a port if its place is free, and returns whether it was.
[[gnu::always_inline]] inline bool TrafficNode::pass(std::size_t d, Cycle now) {
  In& in = ports_.in[d];
  Out& out = ports_.out[d];
  const bool ends_here = in.front().skip == 0, open = !ends_here && out.open(now, 1);
  if (ends_here ? !sink_open(now) : !open && !out.has_place()) return false;
  TrafficToken token = in.take(now);
  arrivals_[d] = in.next();
  if (ends_here) {
    if (!allowances_.empty()) acknowledge(token, d, now);
    deliver(token, now);
    first_in_ = d + 1 < ports_.in.size() ? d + 1 : 0;  // the others first, the next time
    return true;
  }
  --token.skip;
  if (open) {
    out.launch(token, now, token.skip > 0);
  } else {
    out.push(token, now, token.skip > 0);
    ++egress_count_;
  }
  return true;
}

/// While nothing waits here but the source, packets that arrive pass, or the source injects one. Does what there is to
/// do before `end`, as far as that goes, and returns next_here().
Cycle TrafficNode::run_unhindered(Cycle end) {
  while (egress_count_ == 0) {
    const Cycle injection = due_ > now_ ? due_ : next_injection();
    const std::size_t d = first_port();
    const Cycle at = arrivals_[d];
    if (at <= now_) break;  // it waits for the sink
    if (std::min(at, injection) >= end) return std::min(at, injection);
    if (at <= injection) {
      if (!pass(d, at)) return at;
      now_ = at - 1;  // in the same cycle, something may arrive at other ports
    } else {
      now_ = injection;
      inject_all(now_);
    }
  }
  return next_here();
}

/// The port with the first arrival. Each in turn has the sink before the others.
std::size_t TrafficNode::first_port() const {
  std::size_t first = first_in_;
  const std::size_t ways = arrivals_.size();
  for (std::size_t i = 1, d = first_in_; i < ways; ++i) {
    d = d + 1 < ways ? d + 1 : 0;
    if (arrivals_[d] < arrivals_[first]) first = d;
  }
  return first;
}

void TrafficNode::pass_all(Cycle now) {
  const std::size_t ways = arrivals_.size();
  for (std::size_t i = 0, d = first_in_; i < ways; ++i, d = d + 1 < ways ? d + 1 : 0)
    while (arrivals_[d] <= now && pass(d, now)) {
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
  } else if (Out& out = ports_.out[queue.exit]; injects_first_) {
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
  for (std::size_t a = 0; a < ports_.acks_in.size(); ++a) {
    Channel<TrafficAck>& acks = *ports_.acks_in[a];
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
    ports_.acks_out[a]->send(passing.front().at + ack_latency_, passing.front().ack);
}

void TrafficNode::acknowledge(const TrafficToken& token, std::size_t d, Cycle now) {
  const std::size_t a = topology_.ack_direction(d);
  forward_acks(a, now + 1);  // those that came earlier leave earlier
  ports_.acks_out[a]->send(now + ack_latency_, {token.source, static_cast<std::uint16_t>(d)});
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
  for (std::size_t d = 0; d < ports_.out.size(); ++d) {
    const Out& out = ports_.out[d];
    if (!out.empty())
      text += fmt::format("; a packet of resource {}, {} hops from its destination, waits for a place",
                          out.first().source, out.first().skip + 1);
  }
  std::uint64_t unread = 0;  // by the queue that has the most before it
  for (const SourceQueue& queue : queues_)
    if (queue.waiting) unread = std::max(unread, queue.to_create + 1);
  if (unread > 0) text += fmt::format("; {} packets wait to get in", unread);
  return text.empty() ? text : fmt::format("resource {}", id_.value) + text;
}

}  // namespace carousel::ringbus::cycle
