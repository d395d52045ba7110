// The way of a packet through a resource: in, past or through dispatch, and out, or back to its owner.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

void Tile::depart(PacketId id, Cycle ready, bool reserved) {
  const Packet& packet = machine_.packet(id);
  OutPort& out = out_for(packet);
  if (reserved) out.release();
  const bool test = packet.kind == PacketKind::kTest, treelet = resource_.is_treelet(packet.key);
  const bool answers = broadcasts_ && test && packet.owner != id_;
  const std::size_t rays = answers ? rays_in_answer(machine_, id_, id) : packet.members.size();
  Token token{id, 0, static_cast<std::uint16_t>(rays)};
  token.answers = answers;
  PacketLoad load;
  if (answers) {
    const auto n = static_cast<std::uint32_t>(rays);
    const Packet& answer = machine_.answer(id_, id);
    load = packet_size_.answer(packet, answer, n, memory_, treelet);
    token.entries = packet_size_.read_of_answer(packet, answer, n, memory_, treelet);
  } else {
    load = packet_size_.load(packet, memory_, treelet);
    token.entries = packet_size_.read_on_visit(packet, memory_, treelet);
  }
  token.size_bytes = load.bytes;
  token.link_cycles = load.cycles;
  count_sent(packet, load, answers);
  if (broadcasts_ && test && !answers)
    answers_due_[id.value - machine_.first_packet(id_).value] = machine_.topology.other_owners(packet);
  token.skip = machine_.topology.skip(packet, id_);
  out.push(token, ready, !visit_all_ && token.skip > 0);
}

/// By the kind that the header names.
void Tile::count_sent(const Packet& packet, const PacketLoad& load, bool answers) {
  sent_.result += load.messages;
  std::uint64_t* kind = &sent_.box;
  if (answers)
    kind = &sent_.result;
  else if (packet.kind == PacketKind::kRays)
    kind = &sent_.load;
  else if (packet.kind == PacketKind::kMemberships)
    kind = &sent_.join;
  else if (packet.key.ref.is_procedural() && !resource_.is_treelet(packet.key))
    kind = &sent_.procedural;
  else if (!packet.key.ref.is_inner() && !resource_.is_treelet(packet.key))
    kind = &sent_.triangle;
  *kind += load.packets;
}

/// One of the resources that have heard a packet of this one has answered. With the last answer the packet is back.
bool Tile::take_answer(std::size_t d, Cycle now) {
  const PacketId id = ports_.in[d].front().packet;
  std::uint32_t& due = answers_due_[id.value - machine_.first_packet(id_).value];
  const bool own_last = due == 1 && logic_.fate(machine_.packet(id)) == PacketFate::kTestOwn;
  Context* context = own_last ? free_context() : nullptr;
  if (own_last && context == nullptr) return false;
  const Token token = ports_.in[d].take(now);
  occupy_dispatch(now, token.entries, SliceKind::kRetire, id);
  if (--due > 0) return true;
  if (logic_.only_forwards()) {
    discard_at_owner(id);
    return true;
  }
  collect_answers(machine_, id);
  own_last ? test_own_rays(*context, id, now) : retire_at_owner(id, token.entries);
  return true;
}

/// The owner's rays of a packet that is back from the others: dispatch looks for them among all its IDs, and the packet
/// waits in a context for shapes as another's does. It retires when they have been tested.
void Tile::test_own_rays(Context& context, PacketId id, Cycle now) {
  const Packet& packet = machine_.packet(id);
  trace_.note(now, StepKind::kTake, id.value, packet.members.size());
  occupy_dispatch(now, read_on_visit(packet), SliceKind::kVisit, id);
  begin_test(context, id, dispatch_free_, false);
}

/// Dispatch has read `entries` of it.
void Tile::retire_at_owner(PacketId id, std::size_t entries) {
  Packet& packet = machine_.packet(id);
  trace_.note(now_, StepKind::kRetire, id.value, packet.members.size());
  if (recording_.ray != nullptr) [[unlikely]]
    note_retired(packet, id);
  trips_.return_home(id.value, now_);
  sort_ids(logic_.retire(id, packet), entries, id);
  write_spilled(now_);
}

/// The members of part_ come back before the rest of the packet.
void Tile::retire_part(PacketId id, Cycle now) {
  Packet& part = part_.packet;
  trace_.note(now, StepKind::kRetire, id.value, part.members.size());
  if (recording_.ray != nullptr) [[unlikely]]
    note_retired(part, id);
  const std::size_t entries = read_at_owner(part);
  if (entries > 0) occupy_dispatch(now, entries, SliceKind::kRetire, id);
  sort_ids(resource_.retire_part(part), entries, id);
  write_spilled(now);
}

/// The `joined` ray IDs that join collections are put in order of what comes next (US 9633468). Dispatch, which has
/// just read `entries` of the packet, goes on until that is done.
void Tile::sort_ids(std::size_t joined, std::size_t entries, PacketId packet) {
  if (sort_rate_ == 0) return;
  const Cycle read = dispatch_cycles(entries), sorted = ceil_div(joined, sort_rate_);
  if (sorted > read) hold_dispatch(now_, sorted - read, 0, SliceKind::kRetire, packet, true);
}

void Tile::occupy_dispatch(Cycle now, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip) {
  hold_dispatch(now, dispatch_cycles(ids), ids, kind, packet, has_trip);
}

void Tile::hold_dispatch(Cycle now, Cycle cycles, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip) {
  const Cycle start = std::max(dispatch_free_, now);
  if (start != dispatch_ends_) dispatch_since_ = start;
  dispatch_ends_ = dispatch_free_ = start + cycles;
  dispatch_busy_ += cycles;
  if (recording_.slices != nullptr) [[unlikely]]
    note_dispatch(start, ids, kind, packet, has_trip);
}

/// `dispatch_rests`: it takes up nothing in this event, and what can leave at once goes past the egress queue.
bool Tile::cut_through(Cycle now, bool dispatch_rests) {
  if (!cuts_through_) return false;
  bool moved = false;
  for (std::size_t d = 0; d < ports_.in.size(); ++d) {
    InPort& in = ports_.in[d];
    OutPort& out = ports_.out[d];
    while (in.next() <= now && out.has_place() && (window_ > 1 ? choose_to_cut(d, now) : in.front().skip > 0)) {
      Token token = in.take(now);
      --token.skip;
      if (dispatch_rests && out.open(now, 1))
        out.launch(token, now, token.skip > 0);
      else
        out.push(token, now, token.skip > 0);
      moved = true;
    }
  }
  return moved;
}

bool Tile::handle(Cycle now) {
  waits_for_place_ = false;
  if (dispatch_free_ > now) return false;
  for (std::size_t i = 0; i < ports_.in.size(); ++i) {
    const std::size_t d = next_in_ + i < ports_.in.size() ? next_in_ + i : next_in_ + i - ports_.in.size();
    if (ports_.in[d].next() > now || (window_ > 1 && !choose_to_handle(d, now)) || !handle_arrival(d, now)) continue;
    next_in_ = d + 1 == ports_.in.size() ? 0 : d + 1;
    return true;
  }
  return send_new_rays(now) || handle_issue(now);
}

bool Tile::pass_through_dispatch(std::size_t d, Cycle now) {
  if (!visit_all_ || !has_place(ports_.out[d])) return false;
  Token token = ports_.in[d].take(now);
  --token.skip;
  ++passed_;
  passed_rays_ += token.rays;
  occupy_dispatch(now, token.entries, SliceKind::kPass, token.packet);
  ports_.out[d].push(token, dispatch_free_, false);
  return true;
}

bool Tile::handle_arrival(std::size_t d, Cycle now) {
  InPort& in = ports_.in[d];
  if (in.front().skip > 0) return pass_through_dispatch(d, now);
  if (in.front().answers) return take_answer(d, now);
  if (in.front().passes) {
    // Its owner does not wait for this resource, and may have issued it anew.
    const Token token = in.take(now);
    ++passed_;
    passed_rays_ += token.rays;
    occupy_dispatch(now, token.entries, SliceKind::kPass, token.packet, false);
    return true;
  }
  const PacketId id = in.front().packet;
  Packet& packet = machine_.packet(id);
  const PacketFate fate = logic_.fate(packet);
  if (fate == PacketFate::kTestOwn) {
    // It needs no place in an egress queue, and a context becomes free sooner or later: tests always end.
    Context* context = free_context();
    if (context == nullptr) return false;
    in.take(now);
    test_own_rays(*context, id, now);
    return true;
  }
  if (fate == PacketFate::kRetire || fate == PacketFate::kDiscard) {
    const bool retires = fate == PacketFate::kRetire;
    if (packet.kind == PacketKind::kRays) {
      retire_rays(d, now);
      return true;
    }
    in.take(now);
    const std::size_t entries = retires ? read_at_owner(packet) : 0;
    occupy_dispatch(now, entries, SliceKind::kRetire, id);
    retires ? retire_at_owner(id, entries) : discard_at_owner(id);
    return true;
  }
  OutPort& out = out_for(packet);
  if (!has_place(out)) return false;
  if (fate == PacketFate::kTakeRays) {
    visit_with_rays(d, now);
    return true;
  }
  // With a bus, others hear the packet at the same time, and its owner waits for the answers of those with rays of it.
  const bool heard = broadcasts_ && packet.kind == PacketKind::kTest;
  if (logic_.only_forwards()) {
    in.take(now);
    occupy_dispatch(now, 0, SliceKind::kPass, id);
    if (heard) begin_answer(machine_, id_, id);
    depart(id, dispatch_free_, false);
    return true;
  }
  Context* context = fate == PacketFate::kTest ? free_context() : nullptr;
  if (fate == PacketFate::kTest && context == nullptr) return false;
  in.take(now);
  trace_.note(now, StepKind::kTake, id.value, packet.members.size());
  occupy_dispatch(now, read_on_visit(packet), fate == PacketFate::kTest ? SliceKind::kVisit : SliceKind::kPass, id);
  if (fate == PacketFate::kTest) {
    out.reserve();
    begin_test(*context, id, dispatch_free_, false);
    return true;
  }
  const Cycle read = dispatch_free_;
  if (fate == PacketFate::kJoin) {
    const std::size_t ids = packet.members.size();
    resource_.join(packet);
    sort_ids(ids, ids, id);
    write_spilled(now);
  } else {
    ++passed_;
    passed_rays_ += packet.members.size();
  }
  depart(id, read, false);
  return true;
}

}  // namespace carousel::ringbus::cycle
