// A packet's way through a resource: in, past or through the handler, out, and home.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

std::size_t Tile::out_port_of(const Packet& packet) const {
  return machine_.topology.out_port(packet, id_);
}

void Tile::depart(PacketId id, Cycle ready, bool reserved) {
  const Packet& packet = machine_.packet(id);
  OutPort& out = ports_.out[out_port_of(packet)];
  if (reserved) out.release();
  Token token{id, 0, 1, static_cast<std::uint16_t>(packet.members.size())};
  token.link_cycles = static_cast<std::uint16_t>(
      ceil_div(packet_size_.bytes(packet, machine_.memory, resource_.is_treelet(packet.key)), link_bytes_));
  token.skip = machine_.topology.skip(packet, id_);
  out.push(token, ready, !visit_all_ && token.skip > 0);
}

void Tile::retire_at_owner(PacketId id) {
  Packet& packet = machine_.packet(id);
  trace_.note(now_, StepKind::kRetire, id.value, packet.members.size());
  trips_.return_home(id.value, now_);
  resource_.retire(packet);
  free_[packet.direction].push_back(id);
}

void Tile::occupy_dispatch(Cycle now, std::size_t ids) {
  const Cycle cycles = std::max<Cycle>(1, ceil_div(ids, ids_per_cycle_));
  dispatch_free_ = std::max(dispatch_free_, now) + cycles;
  dispatch_busy_ += cycles;
}

bool Tile::cut_through(Cycle now, bool at_once) {
  if (!cuts_through_) return false;
  bool moved = false;
  for (std::size_t d = 0; d < ports_.in.size(); ++d) {
    InPort& in = ports_.in[d];
    OutPort& out = ports_.out[d];
    while (in.next() <= now && in.front().skip > 0 && (at_once ? out.open(now, 1) : out.has_place())) {
      Token token = in.take(now);
      --token.skip;
      if (at_once)
        out.launch(token, now, token.skip > 0);
      else
        out.push(token, now, token.skip > 0);
      moved = true;
    }
  }
  return moved;
}

bool Tile::handle(Cycle now) {
  if (dispatch_free_ > now) return false;
  for (std::size_t i = 0; i < ports_.in.size(); ++i) {
    const std::size_t d = next_in_ + i < ports_.in.size() ? next_in_ + i : next_in_ + i - ports_.in.size();
    if (ports_.in[d].next() > now || !handle_arrival(d, now)) continue;
    next_in_ = d + 1 == ports_.in.size() ? 0 : d + 1;
    return true;
  }
  return handle_issue(now);
}

bool Tile::handle_arrival(std::size_t d, Cycle now) {
  InPort& in = ports_.in[d];
  if (in.front().skip > 0) {
    if (!visit_all_ || !ports_.out[d].has_place()) return false;
    Token token = in.take(now);
    --token.skip;
    ++passed_;
    passed_rays_ += token.rays;
    occupy_dispatch(now, token.rays);
    ports_.out[d].push(token, dispatch_free_, false);
    return true;
  }
  const PacketId id = in.front().packet;
  Packet& packet = machine_.packet(id);
  if (packet.owner == id_) {
    in.take(now);
    occupy_dispatch(now, only_forwards() ? 0 : packet.members.size());
    only_forwards() ? discard_home(id) : retire_at_owner(id);
    return true;
  }
  OutPort& out = ports_.out[out_port_of(packet)];
  if (!out.has_place()) return false;
  if (only_forwards()) {
    in.take(now);
    occupy_dispatch(now, 0);
    depart(id, dispatch_free_, false);
    return true;
  }
  const bool tested = packet.kind == PacketKind::kTest && machine_.topology.wanted(packet, id_);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  in.take(now);
  trace_.note(now, StepKind::kTake, id.value, packet.members.size());
  occupy_dispatch(now, packet.members.size());
  if (tested) {
    out.reserve();
    begin_test(*context, id, dispatch_free_);
  } else {
    if (packet.kind == PacketKind::kMemberships && packet.home == id_) {
      resource_.join(packet);
    } else {
      ++passed_;
      passed_rays_ += packet.members.size();
    }
    depart(id, dispatch_free_, false);
  }
  return true;
}

}  // namespace carousel::ringbus::cycle
