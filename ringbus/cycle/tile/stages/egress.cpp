#include "ringbus/cycle/tile/stages/egress.h"

#include <fmt/format.h>

#include "ringbus/cycle/fabric/course.h"

namespace carousel::ringbus::cycle {

void Egress::depart(PacketId id, Cycle ready, bool reserved) {
  const Packet& packet = machine_.packet(id);
  OutPort& out = port_of(packet);
  if (reserved) out.release();
  const PacketSize& size = needs_.size();
  const bool test = packet.kind == PacketKind::kTest, treelet = needs_.is_treelet(packet);
  const bool heard = machine_.topology.broadcasts() && test, answers = heard && packet.owner != id_;
  const std::size_t rays = answers ? rays_in_answer(machine_, id_, id) : packet.members.size();
  Token token{id, 0, static_cast<std::uint16_t>(rays)};
  token.answers = answers;
  PacketLoad load;
  if (answers) {
    const auto n = static_cast<std::uint32_t>(rays);
    const Packet& answer = machine_.answer(id_, id);
    load = size.answer(packet, answer, n, needs_.memory(), treelet);
    token.entries = size.read_of_answer(packet, answer, n, needs_.memory(), treelet);
  } else {
    load = size.load(packet, needs_.memory(), treelet);
    token.entries = size.read_on_visit(packet, needs_.memory(), treelet);
  }
  token.size_bytes = load.bytes;
  token.link_cycles = load.cycles;
  count_sent(packet, load, answers);
  if (heard && !answers) answers_due(id) = machine_.topology.other_owners(packet);
  token.skip = machine_.topology.skip(packet, id_);
  if (machine_.topology.routed()) {
    token.lane = static_cast<std::uint8_t>(packet.direction);
    token.stop = static_cast<std::uint8_t>(machine_.topology.next(packet, id_).value);
    const Course course = course_of(token, machine_.topology, id_);
    out.push(token, ready, course.through);
    return;
  }
  out.push(token, ready, !machine_.topology.visits_all() && token.skip > 0);
}

/// By the kind that the header names.
void Egress::count_sent(const Packet& packet, const PacketLoad& load, bool answers) {
  sent_.result += load.messages;
  std::uint64_t* kind = &sent_.box;
  if (answers)
    kind = &sent_.result;
  else if (packet.kind == PacketKind::kRays)
    kind = &sent_.load;
  else if (packet.kind == PacketKind::kMemberships)
    kind = &sent_.join;
  else if (packet.key.ref.is_procedural() && !needs_.is_treelet(packet))
    kind = &sent_.procedural;
  else if (!packet.key.ref.is_inner() && !needs_.is_treelet(packet))
    kind = &sent_.triangle;
  *kind += load.packets;
}

std::uint64_t Egress::hops() const {
  std::uint64_t hops = 0;
  for (const OutPort& out : ports_) hops += out.packets();
  return hops;
}

std::string Egress::describe() const {
  std::string text;
  for (std::size_t port = 0; port < ports_.size(); ++port)
    if (const std::string packet = blocked(port); !packet.empty())
      text += fmt::format("; {} cannot leave, {} more behind it", packet, ports_[port].egress() - 1);
  return text;
}

}  // namespace carousel::ringbus::cycle
