#include "ringbus/cycle/fabric/bridge.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

Bridge::Bridge(std::uint32_t group, const Topology& topology, std::span<const Packet> packets, std::vector<InPort> in,
               std::vector<OutPort> out)
    : Hub(std::move(in), std::move(out)), group_(group), topology_(topology), packets_(packets) {}

Cycle Bridge::next() const {
  Cycle first = kNever;
  for (const InPort& in : in_) first = std::min(first, in.next());
  for (const OutPort& out : out_)
    if (const Cycle at = out.next(false); at > now_) first = std::min(first, at);
  return first;
}

void Bridge::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) step(now);
}

void Bridge::step(Cycle now) {
  look_at(now);
  now_ = now;
  for (OutPort& out : out_) out.take_credits(now);
  for (std::size_t i = 0; i < in_.size(); ++i)
    while (in_[i].next() <= now) pass_on(in_[i].take(now), i == 0, now);
  for (OutPort& out : out_) out.send(now);
}

bool Bridge::enters(const Packet& packet, bool from_group) const {
  if (!from_group) return topology_.group_wants(packet, group_);
  // It has been through this group, and goes back into it only when it is the last: its owner is here, and no other
  // group wants it.
  if (topology_.group_of(packet.owner) != group_) return false;
  for (std::uint32_t g = 0; g < topology_.groups().size(); ++g)
    if (g != group_ && topology_.group_wants(packet, g)) return false;
  return true;
}

void Bridge::pass_on(Token token, bool from_group, Cycle now) {
  const Packet& packet = packets_[token.packet.value];
  const bool inwards = enters(packet, from_group);
  token.skip = inwards ? topology_.skip_from_entrance(packet, group_) : 0;
  out_[inwards ? 0 : 1].push(token, now, inwards && token.skip > 0 && !topology_.visits_all());
}

std::string Bridge::describe() const {
  std::size_t egress = 0;
  for (const OutPort& out : out_) egress += out.egress();
  if (egress == 0) return "";
  return fmt::format("bridge {}: {} packets wait to leave", group_, egress);
}

}  // namespace carousel::ringbus::cycle
