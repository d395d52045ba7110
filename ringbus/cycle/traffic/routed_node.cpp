#include "ringbus/cycle/traffic/routed_node.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

namespace {

/// Of what goes in flits the sink takes one at a time.
TrafficNodeSettings of_sink(TrafficNodeSettings settings) {
  if (settings.pieces > 1) settings.flits = 1;
  return settings;
}

std::uint16_t packet_cycles(const TrafficNodeSettings& settings, const Topology::Wire& wire) {
  return static_cast<std::uint16_t>(ceil_div(settings.packet_bytes, static_cast<std::uint64_t>(wire.bytes_per_cycle)));
}

}  // namespace

RoutedNode::RoutedNode(ResourceId id, const Topology& topology, const RingTimes& rings,
                       const TrafficNodeSettings& settings, const MachineClocks& clocks,
                       std::optional<TrafficSource> source, std::uint64_t packets, TrafficWindow window, Ports ports)
    : TrafficAgent(of_sink(settings), window),
      id_(id),
      topology_(topology),
      rings_(rings),
      settings_(settings),
      clocks_(clocks),
      claim_cycles_(topology.claim_cycles(id)),
      in_(std::move(ports.in)),
      out_(std::move(ports.out)),
      source_{std::move(source), packets} {
  const ChannelPlan& plan = topology.channels();
  std::size_t most = 1, queues = 0;
  for (const std::uint32_t link : topology.ports(id).in) {
    entries_.push_back({.first = queues, .queues = plan.channels[link], .claims = ports.claims[entries_.size()]});
    queues += plan.channels[link];
    if (const auto credit = static_cast<Cycle>(topology.wires()[link].credit_cycles); credit > 0)
      source_.credit_cycles = credit + 1 + settings.inject_cycles;
  }
  std::size_t channels = 0;
  for (const std::uint32_t link : topology.ports(id).out) {
    exits_.push_back(
        {.link = link,
         .first = channels,
         .channels = plan.channels[link],
         .cycles = settings.pieces > 1 ? std::uint16_t{1} : packet_cycles(settings, topology.wires()[link])});
    channels += plan.channels[link];
    most = std::max<std::size_t>(most, plan.channels[link]);
  }
  source_.queues.resize(most);
  source_.returns.resize(most);
  const Cycle ahead = std::min(claim_cycles_, settings_.inject_cycles);
  entries_.push_back({.first = queues, .queues = most, .claims = settings_.clock.equal() ? ahead : 0});
  over_.resize(queues + most);
  claimed_.resize(queues + most);
  claims_ = ChannelClaims(queues + most, channels + most);
  exits_.push_back(
      {.first = channels, .channels = most, .cycles = settings.pieces > 1 ? std::uint16_t{1} : settings.flits});
  asking_.resize(entries_.size() * exits_.size());
  offers_.resize(exits_.size());
  create();
}

/// Turns to the source's next packet.
void RoutedNode::create() {
  const Cycle before = source_.next.ready;
  source_.next.ready = kNever;
  if (source_.left == 0) return;
  --source_.left;
  source_.packets->advance();
  const Cycle created = source_.packets->created();
  const ResourceId to = source_.packets->destination();
  const std::uint16_t hops = topology_.route(id_, to, 0).hops;
  source_.next.token = {
      created, static_cast<std::uint16_t>(id_.value), 0, settings_.flits,
      hops,    static_cast<std::uint16_t>(to.value),  0, static_cast<std::uint16_t>(settings_.pieces - 1)};
  const Cycle there = settings_.clock.enter(created + settings_.inject_cycles);
  source_.next.ready = there - entries_.back().claims;
  if (before != kNever) {
    const Cycle apart = settings_.pieces > 1 ? 1 : settings_.flits;  // from its last flit, or from its only piece
    source_.next.ready = std::max(source_.next.ready, before + apart);
  }
  if (created < window_.begin) return;
  ++offered_.packets;
  offered_.routers += hops + 1u;
  offered_.travel += alone(to, there) - created - settings_.inject_cycles;
}

/// Puts what has left the source by `now` into its queues: a packet into the next queue that has a place for its head,
/// and its flits behind one another.
void RoutedNode::fill_source(Cycle now) {
  const std::size_t places = std::size_t{settings_.link_depth} * settings_.pieces;
  const auto full = [&](std::size_t queue) {
    Fifo<Cycle>& returns = source_.returns[queue];
    while (!returns.empty() && returns.front() <= now) returns.pop_front();
    return source_.queues[queue].size() + returns.size() >= places;
  };
  while (!source_.blocked && source_.next.ready <= now) {
    std::size_t queue = source_.last, tried = 0;
    const std::size_t choice = is_head(source_.next.token) ? source_.queues.size() : 1;
    if (choice > 1) queue = next_source_queue(queue);
    while (full(queue) && ++tried < choice) queue = next_source_queue(queue);
    if (tried == choice) {
      Cycle opens = kNever;
      for (std::size_t i = 0; i < source_.returns.size(); ++i)
        if ((choice > 1 || i == source_.last) && !source_.returns[i].empty())
          opens = std::min(opens, source_.returns[i].front());
      source_.blocked = opens == kNever;  // until something has left
      if (!source_.blocked) source_.next.ready = opens;
      return;
    }
    source_.queues[queue].push_back(source_.next);
    source_.last = queue;
    if (source_.next.token.behind == 0) {
      create();
      continue;
    }
    --source_.next.token.behind;
    ++source_.next.ready;
  }
}

/// When a packet that is ready at `there`, by the clock of the node, would be delivered to the sink of its destination
/// if no other were on its way; by the clock of the resources.
Cycle RoutedNode::alone(ResourceId to, Cycle there) const {
  std::vector<Cycle> pieces(settings_.pieces);  // of each piece, by the clock of the node where it is
  for (Cycle& piece : pieces) piece = there++;
  if (to == id_ && settings_.pieces == 1) pieces[0] += settings_.flits - 1u;
  for (ResourceId at = id_; at != to;) {
    const TopologyPlan::Exit exit = topology_.exit(at, to);
    const Topology::Wire& wire = topology_.wires()[topology_.ports(at).out[exit.port]];
    over_link(wire, exit.through, pieces);
    at = wire.to;
    if (const TopologyPlan::StopRing* ring = topology_.ring(wire.to); ring != nullptr) {
      at = topology_.leaves_at(*ring, wire.from, to);
      const Cycle rides = rings_.alone(topology_.ring_number(wire.to), *ring, wire.from, at, settings_.packet_bytes);
      pieces.front() = clocks_.between(wire.mhz, topology_.mhz(at)).enter(pieces.front() + rides + 1);
    }
  }
  Cycle tail = 0;  // the sink takes a piece in each cycle
  for (const Cycle piece : pieces) tail = std::max(tail + 1, piece);
  return clocks_.from_core(topology_.mhz(to)).leave(tail);
}

/// Moves each piece on over a link that is free.
void RoutedNode::over_link(const Topology::Wire& wire, bool through, std::vector<Cycle>& pieces) const {
  const ClockRatio near = clocks_.between(topology_.mhz(wire.from), wire.mhz),
                   far = clocks_.between(wire.mhz, topology_.mhz(wire.to));
  const Cycle cycles = settings_.pieces > 1 ? 1 : packet_cycles(settings_, wire);
  Cycle free = 0, leaves = 0;  // of the link, and of the node, which passes a piece on in each of its cycles
  for (Cycle& piece : pieces) {
    const auto wait = static_cast<Cycle>(wire.node_cycles);
    const Cycle at = std::max({piece, leaves, free > 0 ? near.first_for(free, wait) : 0});
    leaves = at + 1;
    const Cycle edge = near.enter(at + wait);
    free = edge + cycles;
    piece = far.enter(edge + static_cast<Cycle>(wire.latency_cycles) + (through ? 0 : cycles - 1));
  }
}

// ---- time

Cycle RoutedNode::ready(std::size_t queue) const {
  if (!of_source(queue)) return in_[queue].next();
  const Fifo<Waiting>& waiting = source_.queues[queue - in_.size()];
  return waiting.empty() ? kNever : waiting.front().ready;
}

/// When the first flit of a queue with one may claim a channel or leave, as far as the queue goes.
Cycle RoutedNode::waits_until(std::size_t queue, const Entry& entry) const {
  const Cycle there = ready(queue);
  if (there == kNever) return kNever;
  if (must_claim(queue)) return std::max(there, over_[queue]);
  return std::max(is_head(first(queue)) ? there + entry.claims : there, claimed_[queue]);
}

Cycle RoutedNode::next() const {
  Cycle first = source_.blocked ? kNever : source_.next.ready;
  for (const Entry& entry : entries_)
    for (std::size_t queue = entry.first; queue < entry.first + entry.queues; ++queue) {
      Cycle at = waits_until(queue, entry);
      if (at == kNever) continue;
      if (at <= now_) {  // it waits
        const TrafficToken& token = this->first(queue);
        const Exit& exit = exits_[exit_of(token)];
        if (must_claim(queue)) {
          const auto [begin, end] = channels_for(token, of_source(queue), exit);
          at = claims_.any_free(begin, end) ? now_ + 1 : kNever;  // a packet that leaves will free one
        } else {
          at = std::max({entry.free, exit.free, channel_opens(queue, exit), now_ + 1});
        }
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
    for (Exit& exit : exits_) exit.busy[marks_passed_] = busy_at(exit, mark(marks_passed_));
}

Cycle RoutedNode::busy_at(const Exit& exit, Cycle at) const {
  Cycle sum = 0;
  if (is_sink(exit)) return sum;  // its channels are no links
  for (std::size_t channel = 0; channel < exit.channels; ++channel) sum += out_[exit.first + channel].moved(at);
  return sum;
}

Cycle RoutedNode::busy_before(std::size_t port, std::size_t i) const {
  return i < marks_passed_ ? exits_[port].busy[i] : busy_at(exits_[port], mark(i));
}

TrafficAgent::Moved RoutedNode::moved(std::size_t port) const {
  Moved sum;
  for (std::size_t channel = 0; channel < exits_[port].channels; ++channel) {
    const Out& out = out_[exits_[port].first + channel];
    sum.packets += out.packets();
    sum.busy += out.moved();
    sum.stalled += out.stalled();
  }
  sum.packets /= settings_.pieces;
  return sum;
}

void RoutedNode::step(Cycle now) {
  if (marks_passed_ < 2) pass_marks(now);
  now_ = now;
  fill_source(now);
  if (claim_cycles_ > 0) claim(now);
  ask(now);
  for (std::size_t exit = 0; exit < exits_.size(); ++exit) offers_[exit] = offer(exit);
  for (std::size_t entry = 0; entry < entries_.size(); ++entry)
    for (std::size_t i = 0; i < exits_.size(); ++i) {
      const std::size_t exit = (entries_[entry].next_exit + i) % exits_.size();
      if (offers_[exit] != entry) continue;
      move(entry, exit, now);
      break;
    }
}

// ---- packets

std::pair<std::size_t, std::size_t> RoutedNode::channels_for(const TrafficToken& token, bool own,
                                                             const Exit& exit) const {
  if (is_sink(exit)) return {exit.first, exit.first + exit.channels};
  const auto [begin, end] = topology_.channels().range(exit.link, class_of(token, own, exit));
  return {exit.first + begin, exit.first + end};
}

/// Packets that are the first of their queues claim channels.
void RoutedNode::claim(Cycle now) {
  for (const Entry& entry : entries_)
    for (std::size_t queue = entry.first; queue < entry.first + entry.queues; ++queue) {
      if (!must_claim(queue) || waits_until(queue, entry) > now) continue;
      const TrafficToken& token = first(queue);
      const auto [begin, end] = channels_for(token, of_source(queue), exits_[exit_of(token)]);
      if (claims_.any_free(begin, end)) claims_.ask(queue, begin, end);
    }
  claims_.settle([&](std::size_t queue) {
    const auto entry = std::ranges::find_if(entries_, [&](const Entry& one) { return queue < one.first + one.queues; });
    claimed_[queue] = now + (over_[queue] > ready(queue) ? claim_cycles_ : entry->claims);
  });
}

/// The channel with a place that comes after the one that was taken last.
std::optional<std::size_t> RoutedNode::open_channel(std::size_t queue, const Exit& exit, Cycle now) {
  const auto [begin, end] = channels_for(first(queue), of_source(queue), exit);
  const std::size_t many = end - begin;
  for (std::size_t i = 1; i <= many; ++i) {
    const std::size_t channel = begin + (exit.channel + i) % many;
    if (!claims_.taken(channel) && has_place(channel, now)) return channel;
  }
  return std::nullopt;
}

/// When the first flit of a queue may take its channel, as far as channels and places go.
Cycle RoutedNode::channel_opens(std::size_t queue, const Exit& exit) const {
  if (is_sink(exit)) {
    if (claims_.of(queue) != kNone || claims_.any_free(exit.first, exit.first + exit.channels)) return sink_.opens();
    return kNever;
  }
  if (const std::size_t own = claims_.of(queue); own != kNone) return out_[own].opens(1);
  const auto [begin, end] = channels_for(first(queue), of_source(queue), exit);
  Cycle opens = kNever;
  for (std::size_t channel = begin; channel < end; ++channel)
    if (!claims_.taken(channel)) opens = std::min(opens, out_[channel].opens(1));
  return opens;
}

/// When the last flit of what begins to leave a queue for the sink is there. A packet of the source has its head here,
/// and one that has come to its stop has its tail.
Cycle RoutedNode::tail(std::size_t queue, Cycle now) const {
  return of_source(queue) && settings_.pieces == 1 ? now + settings_.flits - 1u : now;
}

/// The first packet of the queue may leave by the exit that it wants.
bool RoutedNode::may_leave(std::size_t queue, std::size_t number, Cycle now) {
  const Exit& exit = exits_[number];
  if (exit.free > now || (is_sink(exit) && !sink_.open(tail(queue, now)))) return false;
  if (const std::size_t own = claims_.of(queue); own != kNone) return has_place(own, now);
  return open_channel(queue, exit, now).has_value();
}

/// Fills in which queues ask for which exits.
void RoutedNode::ask(Cycle now) {
  std::fill(asking_.begin(), asking_.end(), kNone);
  for (std::size_t from = 0; from < entries_.size(); ++from) {
    const Entry& entry = entries_[from];
    if (entry.free > now) continue;
    for (std::size_t i = 0; i < entry.queues; ++i) {
      const std::size_t queue = entry.first + (entry.turn + i) % entry.queues;
      if (waits_until(queue, entry) > now || must_claim(queue)) continue;
      const std::size_t exit = exit_of(first(queue));
      std::size_t& asking = asking_[from * exits_.size() + exit];
      if (asking == kNone && may_leave(queue, exit, now)) asking = queue;
    }
  }
}

/// The entry to which an exit offers itself.
std::optional<std::size_t> RoutedNode::offer(std::size_t exit) const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const std::size_t entry = (exits_[exit].next_entry + i) % entries_.size();
    if (asking_[entry * exits_.size() + exit] != kNone) return entry;
  }
  return std::nullopt;
}

void RoutedNode::move(std::size_t from, std::size_t to, Cycle now) {
  Entry& entry = entries_[from];
  Exit& exit = exits_[to];
  const std::size_t queue = asking_[from * exits_.size() + to];
  const bool own = of_source(queue);
  entry.turn = (queue - entry.first + 1) % entry.queues;
  entry.next_exit = to + 1 < exits_.size() ? to + 1 : 0;
  exit.next_entry = from + 1 < entries_.size() ? from + 1 : 0;
  const bool last = first(queue).behind == 0;
  if (claims_.of(queue) == kNone) {
    const std::size_t channel = *open_channel(queue, exit, now);
    claims_.take(queue, channel);
    exit.channel = channel - channels_for(first(queue), own, exit).first;
  }
  const std::size_t channel = claims_.of(queue);
  if (is_sink(exit)) {
    const Cycle end = tail(queue, now);
    const TrafficToken token = take(queue, now);
    if (last) sink_.deliver(token, end);
    exit.free = now + 1;
    entry.free = end + 1;
  } else {
    const std::uint32_t wanted = class_of(first(queue), own, exit);
    TrafficToken token = take(queue, now);
    token.channel = static_cast<std::uint16_t>(wanted);
    token.link_cycles = exit.cycles;
    out_[channel].launch(token, now, topology_.exit(id_, ResourceId(token.stop)).through);
    exit.free = entry.free = out_[channel].free_at();
  }
  claimed_[queue] = entry.free;
  if (!last) return;
  claims_.release(queue);
  over_[queue] = entry.free;
}

TrafficToken RoutedNode::take(std::size_t queue, Cycle now) {
  if (!of_source(queue)) return in_[queue].take(now);
  Fifo<Waiting>& waiting = source_.queues[queue - in_.size()];
  const TrafficToken token = waiting.front().token;
  waiting.pop_front();
  const Cycle again =
      now + std::max<Cycle>(1, source_.credit_cycles - std::min(source_.credit_cycles, entries_.back().claims));
  if (source_.credit_cycles > 0) source_.returns[queue - in_.size()].push_back(again);
  if (std::exchange(source_.blocked, false)) source_.next.ready = std::max(source_.next.ready, again);
  return token;
}

std::string RoutedNode::describe() const {
  std::string text;
  for (std::size_t queue = 0; queue < in_.size(); ++queue)
    if (in_[queue].next() != kNever)
      text += fmt::format("; a packet of resource {} to resource {} waits", first(queue).source, first(queue).stop);
  std::uint64_t own = source_.left + (source_.next.ready != kNever ? 1 : 0);
  for (const Fifo<Waiting>& waiting : source_.queues) own += waiting.size();
  if (own > 0) text += fmt::format("; {} packets wait to get in", own);
  if (text.empty()) return text;
  const bool resource = id_.value < topology_.resources();
  return fmt::format("{} {}{}", resource ? "resource" : "router",
                     resource ? id_.value : id_.value - topology_.resources(), text);
}

}  // namespace carousel::ringbus::cycle
