#include "ringbus/cycle/traffic_node.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

TrafficNode::TrafficNode(ResourceId id, const Config& config, std::uint64_t packets, TrafficWindow window, Ports ports)
    : topology_(config.topology),
      id_(id),
      ports_(std::move(ports)),
      source_(config.workload.traffic, static_cast<std::uint64_t>(config.image.seed), id,
              static_cast<std::size_t>(config.topology.resources)),
      window_(window),
      inject_cycles_(static_cast<Cycle>(config.workload.traffic.inject_cycles)),
      eject_cycles_(static_cast<Cycle>(config.workload.traffic.eject_cycles)),
      ack_latency_(static_cast<Cycle>(config.topology.link.latency_cycles)),
      flits_(static_cast<std::uint16_t>(ceil_div(static_cast<std::uint64_t>(config.workload.traffic.packet_bytes),
                                                 static_cast<std::uint64_t>(config.topology.link.bytes_per_cycle)))),
      places_wanted_(config.topology.flow == Flow::kBubble && ports_.out_to.empty() ? 2 : 1),
      to_create_(packets),
      window_left_(ports_.acks_in.size(), static_cast<std::uint32_t>(config.topology.link.depth)) {
  create();
}

void TrafficNode::create() {
  waiting_ = to_create_ > 0;
  if (!waiting_) return;
  --to_create_;
  source_.advance();
  const ResourceId to = source_.destination();
  route_ = traffic_route(topology_, id_, to, source_.random());
  exit_ = ports_.out_to.empty() ? route_.direction : ports_.out_to[to.value];
  ready_ = std::max(source_.created() + inject_cycles_, inject_free_);
  if (source_.created() < window_.begin) return;
  ++offered_;
  routers_ += route_.hops + 1u;
}

// ---- time

Cycle TrafficNode::next() const {
  // What is not later than the last step waits for something else, which is looked at too.
  Cycle first = waiting_ ? next_injection() : kNever;
  for (const In& in : ports_.in) {
    const Cycle at = in.next();
    if (at > now_)
      first = std::min(first, at);
    else if (in.front().skip == 0)
      first = std::min(first, sink_free_);
  }
  for (const Out& out : ports_.out)
    if (!out.empty()) first = std::min(first, out.next(false));
  for (const Channel<TrafficAck>* acks : ports_.acks_in) first = std::min(first, acks->next());
  return first;
}

Cycle TrafficNode::next_injection() const {
  if (ready_ > now_) return ready_;
  if (route_.hops == 0) return sink_free_ - (flits_ - 1u);
  if (!window_left_.empty() && window_left_[route_.direction] == 0) return kNever;   // until an ack comes
  return ports_.out[exit_].opens(places_wanted_);
}

void TrafficNode::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void TrafficNode::step(Cycle now) {
  now_ = now;
  for (Out& out : ports_.out) {
    out.take_credits(now);
    out.send(now);
  }
  take_acks(now);
  const std::size_t ways = ports_.in.size(), first = first_in_;
  for (std::size_t i = 0; i < ways; ++i) pass(first + i < ways ? first + i : first + i - ways, now);
  if (waiting_ && ready_ <= now) inject(now);
}

// ---- packets

void TrafficNode::pass(std::size_t d, Cycle now) {
  In& in = ports_.in[d];
  while (in.next() <= now) {
    if (in.front().skip == 0) {
      if (!sink_open(now)) return;
      const TrafficToken token = in.take(now);
      if (!ports_.acks_out.empty())
        ports_.acks_out[ack_direction(d)]->send(now + ack_latency_, {token.source, static_cast<std::uint16_t>(d)});
      deliver(token, now);
      first_in_ = d + 1 < ports_.in.size() ? d + 1 : 0;   // the others first, the next time
      continue;
    }
    Out& out = ports_.out[d];
    if (!out.has_place()) return;
    TrafficToken token = in.take(now);
    --token.skip;
    out.push(token, now, token.skip > 0);
    out.send(now);
  }
}

void TrafficNode::inject(Cycle now) {
  const TrafficToken token{source_.created(), static_cast<std::uint16_t>(id_.value),
                           static_cast<std::uint16_t>(route_.hops == 0 ? 0 : route_.hops - 1), flits_};
  if (route_.hops == 0) {
    const Cycle tail = now + flits_ - 1u;
    if (!sink_open(tail)) return;
    deliver(token, tail);
  } else {
    Out& out = ports_.out[exit_];
    if (!out.open(now, places_wanted_)) return;
    if (!window_left_.empty()) {
      if (window_left_[route_.direction] == 0) return;
      --window_left_[route_.direction];
    }
    out.push(token, now, token.skip > 0);
    out.send(now);
  }
  inject_free_ = now + flits_;
  create();
}

void TrafficNode::deliver(const TrafficToken& token, Cycle tail) {
  sink_free_ = tail + flits_;
  last_ = tail + eject_cycles_;   // the sink's packets come one after the other
  ++delivered_;
  accepted_ += last_ >= window_.begin && last_ < window_.end;
  if (token.created >= window_.begin) latency_.add(last_ - token.created);
}

// ---- word of deliveries

std::size_t TrafficNode::ack_direction(std::size_t d) const {
  return topology_.shape == TopologyShape::kBidirectional ? 1 - d : d;
}

void TrafficNode::take_acks(Cycle now) {
  for (std::size_t a = 0; a < ports_.acks_in.size(); ++a) {
    while (ports_.acks_in[a]->next() <= now) {
      const TrafficAck ack = ports_.acks_in[a]->take();
      if (ack.source == id_.value)
        ++window_left_[ack.direction];
      else
        ports_.acks_out[a]->send(now + ack_latency_, ack);
    }
  }
}

// ---- the end, good or bad

std::string TrafficNode::describe() const {
  std::string text;
  for (std::size_t d = 0; d < ports_.out.size(); ++d) {
    const Out& out = ports_.out[d];
    if (!out.empty())
      text += fmt::format("; a packet of resource {}, {} hops from its destination, waits for a place", out.first().source,
                          out.first().skip + 1);
  }
  if (waiting_) text += fmt::format("; {} packets wait to get in", to_create_ + 1);
  return text.empty() ? text : fmt::format("resource {}", id_.value) + text;
}

}  // namespace carousel::ringbus::cycle
