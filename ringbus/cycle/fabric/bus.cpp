#include "ringbus/cycle/fabric/bus.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

Bus::Bus(const Topology& topology, std::span<const Packet> packets, std::vector<InPort> in, std::vector<OutPort> out)
    : Hub(std::move(in), std::move(out)), topology_(topology), packets_(packets) {}

Cycle Bus::next() const {
  Cycle first = kNever;
  bool waiting = false;
  for (const InPort& in : in_) {
    waiting |= in.next() <= now_;
    if (in.next() > now_) first = std::min(first, in.next());
  }
  // An egress queue holds something only on links with faults, which are busy for longer than the bus.
  for (const OutPort& out : out_)
    if (!out.empty()) first = std::min(first, out.next(false));
  if (!waiting) return first;
  if (free_at_ > now_) return std::min(first, free_at_);
  // The bus is free, and yet packets wait: for places at their next stops.
  for (const OutPort& out : out_)
    if (out.empty()) first = std::min(first, out.next(true));
  return first;
}

void Bus::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) {
    look_at(now);
    now_ = now;
    for (OutPort& out : out_) {
      out.take_credits(now);
      out.send(now);
    }
    if (free_at_ <= now) move_one(now);
  }
}

void Bus::find_listeners(const Token& token, ResourceId from) {
  const Packet& packet = packets_[token.packet.value];
  listeners_.clear();
  if (token.answers) {
    listeners_.push_back(packet.owner.value);
  } else if (packet.kind != PacketKind::kTest) {
    listeners_.push_back(topology_.next(packet, from).value);
  } else {
    for (std::uint32_t r = 0; r < topology_.resources(); ++r)
      if (r != from.value && (topology_.visits_all() || topology_.wanted(packet, ResourceId(r))))
        listeners_.push_back(r);
  }
}

void Bus::move_one(Cycle now) {
  for (std::size_t i = 0; i < in_.size(); ++i) {
    const std::size_t from = (turn_ + i) % in_.size();
    if (in_[from].next() > now) continue;
    find_listeners(in_[from].front(), ResourceId(static_cast<std::uint32_t>(from)));
    if (std::any_of(listeners_.begin(), listeners_.end(),
                    [&](std::uint32_t to) { return out_[to].spare_places() <= 0; }))
      continue;
    Token token = in_[from].take(now);
    const Packet& packet = packets_[token.packet.value];
    const bool heard = packet.kind == PacketKind::kTest && !token.answers;
    for (const std::uint32_t to : listeners_) {
      token.passes = heard && !topology_.wanted(packet, ResourceId(to));
      out_[to].push(token, now, false);
      out_[to].send(now);
    }
    free_at_ = now + token.link_cycles;
    turn_ = from + 1;
    return;
  }
}

}  // namespace carousel::ringbus::cycle
