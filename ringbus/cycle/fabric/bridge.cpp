#include "ringbus/cycle/fabric/bridge.h"

#include <algorithm>

#include <fmt/format.h>

namespace carousel::ringbus::cycle {

Bridge::Bridge(std::uint32_t group, CycleMachine& machine, std::vector<InPort> in, std::vector<OutPort> out)
    : group_(group), machine_(machine), in_(std::move(in)), out_(std::move(out)) {}

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
  now_ = now;
  for (OutPort& out : out_) out.take_credits(now);
  for (std::size_t i = 0; i < in_.size(); ++i)
    while (in_[i].next() <= now) pass_on(in_[i].take(now), i == 0, now);
  for (OutPort& out : out_) out.send(now);
}

void Bridge::pass_on(Token token, bool from_group, Cycle now) {
  const Packet& packet = machine_.packet(token.packet);
  const Topology& topology = machine_.topology;
  bool enters = topology.group_wants(packet, group_);
  if (from_group) {
    // It has done with this group, unless it is at home and nobody else wants it.
    enters = topology.group_of(packet.owner) == group_;
    for (std::uint32_t g = 0; enters && g < topology.groups().size(); ++g)
      enters = g == group_ || !topology.group_wants(packet, g);
  }
  token.skip = enters ? topology.skip_from_entrance(packet, group_) : 0;
  const bool cut_through = enters && token.skip > 0 && machine_.config.topology.visit == Visit::kOwners;
  out_[enters ? 0 : 1].push(token, now, cut_through);
}

std::string Bridge::describe() const {
  std::size_t egress = 0;
  for (const OutPort& out : out_) egress += out.egress();
  if (egress == 0) return "";
  return fmt::format("bridge {}: {} packets in hand", group_, egress);
}

}  // namespace carousel::ringbus::cycle
