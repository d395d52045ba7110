#include "ringbus/cycle/traffic/routed_node.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

namespace {

std::uint16_t packet_cycles(const TrafficNodeSettings& settings, const Topology::Wire& wire) {
  return static_cast<std::uint16_t>(ceil_div(settings.packet_bytes, static_cast<std::uint64_t>(wire.bytes_per_cycle)));
}

}  // namespace

RoutedNode::RoutedNode(ResourceId id, const Topology& topology, const TrafficNodeSettings& settings,
                       std::optional<TrafficSource> source, std::uint64_t packets, TrafficWindow window, Ports ports)
    : TrafficAgent(settings, window),
      id_(id),
      topology_(topology),
      settings_(settings),
      in_(std::move(ports.in)),
      out_(std::move(ports.out)),
      queue_free_(in_.size() + 1),
      exits_(out_.size() + 1),
      source_{std::move(source), packets, {}} {
  for (const std::uint32_t wire : topology.ports(id).out)
    cycles_.push_back(packet_cycles(settings, topology.wires()[wire]));
  create();
}

/// Turns to the source's next packet.
void RoutedNode::create() {
  source_.ready = kNever;
  if (source_.left == 0) return;
  --source_.left;
  source_.packets->advance();
  const Cycle created = source_.packets->created();
  const ResourceId to = source_.packets->destination();
  const std::uint16_t hops = topology_.route(id_, to, 0).hops;
  source_.token = {created, static_cast<std::uint16_t>(id_.value), 0, settings_.flits,
                   hops,    static_cast<std::uint16_t>(to.value)};
  source_.ready = std::max(created + settings_.inject_cycles, source_.free);
  if (created < window_.begin) return;
  ++offered_.packets;
  offered_.routers += hops + 1u;
  offered_.travel += alone(to);
}

/// Cycles of a packet's way if no other is on it.
Cycle RoutedNode::alone(ResourceId to) const {
  if (to == id_) return settings_.flits - 1u;
  Cycle sum = 0;
  for (ResourceId at = id_; at != to;) {
    const TopologyPlan::Exit exit = topology_.exit(at, to);
    const Topology::Wire& wire = topology_.wires()[topology_.ports(at).out[exit.port]];
    sum += static_cast<Cycle>(wire.node_cycles + wire.latency_cycles);
    if (!exit.through) sum += packet_cycles(settings_, wire) - 1u;
    at = wire.to;
  }
  return sum;
}

// ---- time

Cycle RoutedNode::next() const {
  Cycle first = kNever;
  for (std::size_t queue = 0; queue < queue_free_.size(); ++queue) {
    Cycle at = ready(queue);
    if (at == kNever) continue;
    if (at <= now_) {  // it waits
      const std::size_t exit = exit_of(this->first(queue));
      at = std::max(queue_free_[queue], exit < out_.size() ? out_[exit].opens(1) : sink_.opens());
      at = std::max(at, now_ + 1);
    }
    first = std::min(first, at);
  }
  return first;
}

void RoutedNode::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void RoutedNode::pass_marks(Cycle now) {
  for (; marks_passed_ < 2 && mark(marks_passed_) <= now; ++marks_passed_)
    for (std::size_t port = 0; port < out_.size(); ++port)
      exits_[port].busy[marks_passed_] = out_[port].busy(mark(marks_passed_));
}

void RoutedNode::step(Cycle now) {
  if (marks_passed_ < 2) pass_marks(now);
  now_ = now;
  for (std::size_t exit = 0; exit < exits_.size(); ++exit) grant(exit, now);
}

// ---- packets

/// Lets one packet leave by an exit, if any can.
bool RoutedNode::grant(std::size_t exit, Cycle now) {
  const bool sink = exit == out_.size();
  for (std::size_t i = 0; i < queue_free_.size(); ++i) {
    const std::size_t queue = (exits_[exit].turn + i) % queue_free_.size();
    if (ready(queue) > now || queue_free_[queue] > now || exit_of(first(queue)) != exit) continue;
    // A packet of the source has its head here, and one that has come to its stop has its tail.
    const Cycle tail = queue < in_.size() ? now : now + settings_.flits - 1u;
    if (sink ? !sink_.open(tail) : !out_[exit].open(now, 1)) return false;
    move(queue, exit, now);
    exits_[exit].turn = queue + 1 < queue_free_.size() ? queue + 1 : 0;
    return true;
  }
  return false;
}

void RoutedNode::move(std::size_t queue, std::size_t exit, Cycle now) {
  const bool own = queue == in_.size();
  TrafficToken token = own ? source_.token : in_[queue].take(now);
  if (exit == out_.size()) {
    sink_.deliver(token, own ? now + settings_.flits - 1u : now);
    if (own) queue_free_[queue] = now + settings_.flits;
  } else {
    token.link_cycles = cycles_[exit];
    out_[exit].launch(token, now, topology_.exit(id_, ResourceId(token.stop)).through);
    queue_free_[queue] = now + token.link_cycles;
  }
  if (!own) return;
  source_.free = queue_free_[queue];
  create();
}

std::string RoutedNode::describe() const {
  std::string text;
  for (std::size_t queue = 0; queue < in_.size(); ++queue)
    if (in_[queue].next() != kNever)
      text += fmt::format("; a packet of resource {} to resource {} waits", first(queue).source, first(queue).stop);
  if (source_.ready != kNever) text += fmt::format("; {} packets wait to get in", source_.left + 1);
  if (text.empty()) return text;
  const bool resource = id_.value < topology_.resources();
  return fmt::format("{} {}", resource ? "resource" : "router",
                     resource ? id_.value : id_.value - topology_.resources()) +
         text;
}

}  // namespace carousel::ringbus::cycle
