#include "ringbus/cycle/traffic/traffic_node.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

TrafficNode::TrafficNode(ResourceId id, const Topology& topology, const FlowRules& flow,
                         const TrafficNodeSettings& settings, TrafficSource source, std::uint64_t packets,
                         TrafficWindow window, Ports ports)
    : TrafficAgent(settings, window),
      id_(id),
      flits_(settings.flits),
      link_latency_(settings.link_latency),
      places_wanted_(flow.places_to_inject()),
      injects_first_(flow.injects_first()),
      queues_(id, topology, settings, std::move(source), packets, window, ports.in.size()),
      credits_(id, topology, settings, std::move(ports.acks_in), std::move(ports.acks_out)) {
  for (std::size_t d = 0; d < ports.in.size(); ++d) ways_.push_back({ports.in[d], std::move(ports.out[d])});
}

// ---- time

Cycle TrafficNode::next() const {
  Cycle first = next_here();
  for (const Way& way : ways_)
    if (const Cycle at = way.in.next(); at > now_) first = std::min(first, at);
  return std::min(first, credits_.next());
}

/// The time at which a packet that is ready may be injected, as far as is known.
[[gnu::always_inline]] inline Cycle TrafficNode::next_injection(const SourceQueues::Queue& queue) const {
  if (queue.route.hops == 0) return sink_.opens() - (flits_ - 1u);
  if (credits_.on())
    if (const Cycle at = credits_.opens(queue.route.direction, now_); at > now_) return at;
  return ways_[queue.exit].out.opens(places_wanted_);
}

[[gnu::always_inline]] inline Cycle TrafficNode::next_injection() const {
  if (queues_.due() > now_) return queues_.due();
  Cycle first = kNever;
  for (const SourceQueues::Queue& queue : queues_.all())
    first = std::min(first, queue.due > now_ ? queue.due : next_injection(queue));
  return first;
}

Cycle TrafficNode::next_here() const {
  Cycle first = next_injection();
  for (const Way& way : ways_) {
    // An arrival that is not later than the last step waits: for the sink, or for the egress place.
    if (way.arrival > now_)
      first = std::min(first, way.arrival);
    else if (!sink_.open(now_) && way.in.front().skip == 0)
      first = std::min(first, sink_.opens());
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
  const auto lacks_credits = [this](const SourceQueues::Queue& queue) {
    return queue.due <= now_ && queue.route.hops > 0 && ways_[queue.exit].out.lacks_credits(places_wanted_);
  };
  return queues_.due() <= now_ && std::any_of(queues_.all().begin(), queues_.all().end(), lacks_credits);
}

void TrafficNode::run(Cycle end) {
  // Packets that are sent to it from now on arrive after `end`, so it is enough to look once.
  for (Way& way : ways_) way.arrival = way.in.next();
  if (credits_.on()) credits_.take(end);
  if (marks_passed_ < 2) pass_marks(end);
  advance(end);
  if (credits_.on()) {
    credits_.forward(end);
    next_ = std::min(next_, credits_.next());
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
    if (injects_first_ && queues_.due() <= now_) inject_all(now_);
    pass_all(now_);
    if (queues_.due() <= now_) inject_all(now_);
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
  if (ends_here ? !sink_.open(now) : !open && !way.out.has_place()) return false;
  TrafficToken token = way.in.take(now);
  way.arrival = way.in.next();
  if (ends_here) {
    const std::size_t d = static_cast<std::size_t>(&way - ways_.data());
    if (credits_.on()) credits_.acknowledge(token, d, now);
    sink_.deliver(token, now);
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
  queues_.for_each_due(now, [&](SourceQueues::Queue& queue) { inject(queue, now); });
}

void TrafficNode::inject(SourceQueues::Queue& queue, Cycle now) {
  const std::uint16_t hops = queue.route.hops;
  const TrafficToken token{queue.source.created(), static_cast<std::uint16_t>(id_.value),
                           static_cast<std::uint16_t>(hops == 0 ? 0 : hops - 1), flits_, hops};
  if (hops == 0) {
    const Cycle tail = now + flits_ - 1u;
    if (!sink_.open(tail)) return;
    sink_.deliver(token, tail);
  } else if (Out& out = ways_[queue.exit].out; injects_first_) {
    if (!out.has_place()) return;
    out.push(token, now, token.skip > 0);
    out.take_credits(now);
    if (!out.send(now)) ++egress_count_;
  } else {
    if (!out.open(now, places_wanted_) || (credits_.on() && !credits_.use(queue.route.direction, now))) return;
    out.launch(token, now, token.skip > 0);
  }
  queues_.injected(queue, now);
}

// ---- the end, good or bad

std::string TrafficNode::describe() const {
  std::string text;
  for (const Way& way : ways_)
    if (!way.out.empty())
      text += fmt::format("; a packet of resource {}, {} hops from its destination, waits for a place",
                          way.out.first().source, way.out.first().skip + 1);
  if (const std::uint64_t left = queues_.left(); left > 0) text += fmt::format("; {} packets wait to get in", left);
  return text.empty() ? text : fmt::format("resource {}", id_.value) + text;
}

}  // namespace carousel::ringbus::cycle
