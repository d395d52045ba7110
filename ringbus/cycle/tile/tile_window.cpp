// The choice among the first packets of an input queue (`testers.window`; US 9633468 lets a resource look at several
// packets of its queue and process them out of order where that helps). It takes the first one that can go on at once
// and needs no shapes from memory, otherwise the first one that can go on. It looks at all of them at the same time;
// dispatch needs a cycle more if it takes another than the first. So that none waits for ever, the first one is passed
// over at most as often as the window is long.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

/// How many packets of a queue it looks at.
std::size_t Tile::seen(std::size_t d, Cycle now) const {
  return std::min(window_, ports_.in[d].arrived(now));
}

/// Brings a packet that only passes to the front, if there is one.
bool Tile::choose_to_cut(std::size_t d, Cycle now) {
  InPort& in = ports_.in[d];
  for (std::size_t i = 0, end = seen(d, now); i < end; ++i) {
    if (in.peek(i).skip == 0) continue;
    in.bring_forward(i);
    return true;
  }
  return false;
}

/// Brings the packet that dispatch takes next to the front, if it can take one.
bool Tile::choose_to_handle(std::size_t d, Cycle now) {
  InPort& in = ports_.in[d];
  const std::size_t end = passed_over_[d] >= window_ ? 1 : seen(d, now);
  std::size_t chosen = end;
  for (std::size_t i = 0; i < end; ++i) {
    const Token& token = in.peek(i);
    if (!can_handle(d, token)) continue;
    const bool waits = waits_for_shapes(token);
    if (chosen == end || !waits) chosen = i;
    if (!waits) break;
  }
  if (chosen == end) return false;
  if (chosen == 0) {
    passed_over_[d] = 0;
    return true;
  }
  ++passed_over_[d];
  in.bring_forward(chosen);
  hold_dispatch(now, 1, 0, SliceKind::kPass, in.front().packet, !in.front().passes);
  return true;
}

/// Tells whether handle_arrival() takes it.
bool Tile::can_handle(std::size_t d, const Token& token) {
  if (token.skip > 0) return visit_all_ && ports_.out[d].has_place();
  if (token.passes) return true;
  const Packet& packet = machine_.packet(token.packet);
  const PacketFate fate = logic_.fate(packet);
  if (token.answers) {
    const bool last = answers_due_[token.packet.value - machine_.first_packet(id_).value] == 1;
    return !last || fate != PacketFate::kTestOwn || free_context() != nullptr;
  }
  switch (fate) {
    case PacketFate::kTestOwn:
      return free_context() != nullptr;
    case PacketFate::kRetire:
    case PacketFate::kDiscard:
      return true;
    case PacketFate::kTest:
      return out_for(packet).has_place() && free_context() != nullptr;
    default:
      return out_for(packet).has_place();
  }
}

bool Tile::waits_for_shapes(const Token& token) const {
  if (!fetch_by_resource_ || token.skip > 0 || token.passes || token.answers) return false;
  const Packet& packet = machine_.packet(token.packet);
  const PacketFate fate = logic_.fate(packet);
  if ((fate != PacketFate::kTest && fate != PacketFate::kTestOwn) || resource_.is_treelet(packet.key)) return false;
  return !shapes_.has(shape_data(packet, false)[0]);
}

}  // namespace carousel::ringbus::cycle
