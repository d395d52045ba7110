#include "ringbus/cycle/tile/stages/dispatcher.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/types/added_names.h"
#include "ringbus/protocol/answers.h"

namespace carousel::ringbus::cycle {

Dispatcher::Dispatcher(const TileParts& parts, const TileSettings& settings, std::vector<InPort>& in,
                       TestContexts& contexts, IssueQueue& issue, RayEntry& entry, const ShadeHelp& help)
    : parts_(parts),
      in_(in),
      contexts_(contexts),
      issue_(issue),
      entry_(entry),
      help_(help),
      visit_all_(parts.machine.topology.visits_all()),
      routed_(parts.machine.topology.routed()),
      cuts_through_(routed_ || (!visit_all_ && !parts.machine.topology.direct())),
      broadcasts_(parts.machine.topology.broadcasts()),
      fetch_by_resource_(settings.fetches_by_resource()),
      rule_(added_body<DispatchRule>(settings.testers.dispatch)),
      rule_name_(enum_name(settings.testers.dispatch)),
      window_(static_cast<std::size_t>(settings.testers.window)),
      passed_over_(in.size()) {}

bool Dispatcher::handle(Cycle now) {
  parts_.egress.forget_waits();
  if (parts_.dispatch.free_at() > now) return false;
  for (std::size_t i = 0; i < in_.size(); ++i) {
    const std::size_t d = next_in_ + i < in_.size() ? next_in_ + i : next_in_ + i - in_.size();
    if (in_[d].next() > now || (has_window() && !choose_to_handle(d, now)) || !handle_arrival(d, now)) continue;
    next_in_ = d + 1 == in_.size() ? 0 : d + 1;
    return true;
  }
  return entry_.send(now, issue_.empty()) || handle_issue(now);
}

bool Dispatcher::cut_through(Cycle now, bool dispatch_rests) {
  if (!cuts_through_) return false;
  bool moved = false;
  for (std::size_t d = 0; d < in_.size(); ++d) {
    InPort& in = in_[d];
    while (in.next() <= now && (has_window() ? choose_to_cut(d, now) : passes_by(in.front()))) {
      OutPort& out = way_of(d, in.front());
      if (!out.has_place()) break;
      Token token = in.take(now);
      const bool through = pass_by(token);
      if (dispatch_rests && out.open(now, 1))
        out.launch(token, now, through);
      else
        out.push(token, now, through);
      moved = true;
    }
  }
  return moved;
}

// ---- packets that have arrived

std::optional<Dispatcher::Decision> Dispatcher::decide(std::size_t d, const Token& token) {
  if (passes_by(token) && (routed_ || !visit_all_)) return std::nullopt;
  if (token.skip > 0) {
    const std::size_t port = routed_ ? parts_.logic.out_port(parts_.machine.packet(token.packet)) : d;
    return Decision{Action::kPassOn, &parts_.egress.port(port)};
  }
  if (token.passes && !token.answers) return Decision{Action::kHear};
  const Packet& packet = parts_.machine.packet(token.packet);
  const PacketFate fate = parts_.logic.fate(packet);
  if (token.answers) {
    const bool last = parts_.egress.answers_due(token.packet) == 1;
    return Decision{Action::kTakeAnswer, nullptr, last && fate == PacketFate::kTestOwn};
  }
  const bool rays = packet.kind == PacketKind::kRays;
  switch (fate) {
    case PacketFate::kTestOwn:  // a context becomes free sooner or later: tests always end
      return Decision{Action::kTestOwn, nullptr, true};
    case PacketFate::kRetire:
      return Decision{rays ? Action::kRetireRays : Action::kRetire};
    case PacketFate::kDiscard:
      return Decision{rays ? Action::kRetireRays : Action::kDiscard};
    case PacketFate::kTakeRays:
      return Decision{Action::kTakeRays, &parts_.egress.port_of(packet)};
    case PacketFate::kTest:
      return Decision{Action::kTest, &parts_.egress.port_of(packet), true};
    case PacketFate::kJoin:
      return Decision{Action::kJoin, &parts_.egress.port_of(packet)};
    case PacketFate::kIdleVisit:
    case PacketFate::kForward:
      break;
  }
  const Action action = parts_.logic.only_forwards() ? Action::kForward : Action::kVisit;
  return Decision{action, &parts_.egress.port_of(packet)};
}

bool Dispatcher::handle_arrival(std::size_t d, Cycle now) {
  const std::optional<Decision> decision = decide(d, in_[d].front());
  if (!decision || !may_take(*decision)) return false;
  take(*decision, d, now);
  return true;
}

void Dispatcher::take(const Decision& decision, std::size_t d, Cycle now) {
  Token token = in_[d].take(now);
  const PacketId id = token.packet;
  Packet& packet = parts_.machine.packet(id);
  switch (decision.action) {
    case Action::kPassOn:
      --token.skip;
      parts_.dispatch.count_idle_visit(token.rays);
      parts_.dispatch.occupy(now, token.entries, SliceKind::kPass, id);
      if (routed_) token.stop = static_cast<std::uint8_t>(parts_.machine.topology.next(packet, this->id()).value);
      decision.place->push(token, parts_.dispatch.free_at(), routed_ && pass_by(token));
      return;
    case Action::kHear:  // its owner may have issued it anew
      parts_.dispatch.count_idle_visit(token.rays);
      parts_.dispatch.occupy(now, token.entries, SliceKind::kPass, id, false);
      return;
    case Action::kTakeAnswer:
      return take_answer(decision, token, now);
    case Action::kTestOwn:
      return test(id, parts_.needs.read_on_visit(packet), now);
    case Action::kRetire: {
      const std::size_t entries = parts_.needs.read_at_owner(packet);
      parts_.dispatch.occupy(now, entries, SliceKind::kRetire, id);
      return parts_.retirement.retire(id, packet, entries, now);
    }
    case Action::kDiscard:
      parts_.dispatch.occupy(now, 0, SliceKind::kRetire, id);
      return parts_.retirement.discard(id, now);
    case Action::kRetireRays:
      return entry_.retire(id, now);
    case Action::kTakeRays:
      return entry_.visit(id, now);
    case Action::kForward:
      parts_.dispatch.occupy(now, 0, SliceKind::kPass, id);
      // With a bus, others hear the packet at the same time, and its owner waits for the answers of those with rays of
      // it.
      if (broadcasts_ && packet.kind == PacketKind::kTest) begin_answer(parts_.machine, this->id(), id);
      return parts_.egress.depart(id, parts_.dispatch.free_at(), false);
    case Action::kTest:
    case Action::kVisit:
    case Action::kJoin:
      return visit(decision.action, id, now);
  }
}

/// One of the resources that have heard a packet of this one has answered. With the last answer the packet is back.
void Dispatcher::take_answer(const Decision& decision, const Token& token, Cycle now) {
  const PacketId id = token.packet;
  parts_.dispatch.occupy(now, token.entries, SliceKind::kRetire, id);
  if (--parts_.egress.answers_due(id) > 0) return;
  if (parts_.logic.only_forwards()) return parts_.retirement.discard(id, now);
  collect_answers(parts_.machine, id);
  Packet& packet = parts_.machine.packet(id);
  decision.needs_context ? test(id, parts_.needs.read_on_visit(packet), now)
                         : parts_.retirement.retire(id, packet, token.entries, now);
}

/// Dispatch looks for rays of this resource among `entries` entries of the packet, which takes a test context. That may
/// be the owner, for its own rays, when the packet is back from the others; it retires when they have been tested.
void Dispatcher::test(PacketId id, std::size_t entries, Cycle now) {
  parts_.recorder.step(now, StepKind::kTake, id.value, parts_.machine.packet(id).members.size());
  parts_.dispatch.occupy(now, entries, SliceKind::kVisit, id);
  contexts_.begin(contexts_.first_free(), id, now, parts_.dispatch.free_at(), false);
}

/// A packet of another resource, which goes on afterwards.
void Dispatcher::visit(Action action, PacketId id, Cycle now) {
  Packet& packet = parts_.machine.packet(id);
  const std::size_t entries = parts_.needs.read_on_visit(packet);
  if (action == Action::kTest) {
    parts_.egress.port_of(packet).reserve();
    return test(id, entries, now);
  }
  parts_.recorder.step(now, StepKind::kTake, id.value, packet.members.size());
  parts_.dispatch.occupy(now, entries, SliceKind::kPass, id);
  const Cycle read = parts_.dispatch.free_at();
  if (action == Action::kJoin)
    parts_.retirement.join(id, packet, now);
  else
    parts_.dispatch.count_idle_visit(packet.members.size());
  parts_.egress.depart(id, read, false);
}

// ---- packets of its own

bool Dispatcher::handle_issue(Cycle now) {
  if (!issue_.front_is_ready()) return false;
  const PacketId id = issue_.front().packet;
  const Packet& packet = parts_.machine.packet(id);
  const bool travels = parts_.logic.travels(packet);
  if (travels && !parts_.egress.may_inject(packet)) return false;
  const bool own_last = parts_.logic.tests_own_last(packet), tested = !own_last && parts_.logic.has_rays_of(packet);
  if (tested && !context_is_free()) return false;
  const IssueQueue::Entry entry = issue_.take();
  parts_.retirement.trips().inject(id.value, now);
  if (entry.takes_data) parts_.recorder.shapes_came(id, parts_.shapes.here_since(entry.user));
  parts_.recorder.step(now, StepKind::kIssue, id.value, packet.members.size());
  parts_.dispatch.occupy(now, packet.members.size(), SliceKind::kIssue, id);
  if (tested) {
    const std::size_t context = contexts_.first_free();
    if (travels) parts_.egress.port_of(packet).reserve();
    if (entry.takes_data) parts_.shapes.hand_over(entry.user, static_cast<ShapeBuffer::User>(context));
    contexts_.begin(context, id, now, parts_.dispatch.free_at(), entry.takes_data);
    return true;
  }
  if (entry.takes_data) parts_.shapes.release(entry.user, now);  // the packet takes them along
  if (packet.kind == PacketKind::kTest && !own_last) parts_.dispatch.count_idle_visit(packet.members.size());
  parts_.egress.depart(id, parts_.dispatch.free_at(), false);
  return true;
}

// ---- the choice among packets that have arrived

/// How many packets of a queue it looks at.
std::size_t Dispatcher::seen(std::size_t d, Cycle now) const {
  return std::min(window_, in_[d].arrived(now));
}

/// Brings a packet that only passes to the front, if there is one with a place to leave.
bool Dispatcher::choose_to_cut(std::size_t d, Cycle now) {
  InPort& in = in_[d];
  for (std::size_t i = 0, end = seen(d, now); i < end; ++i) {
    if (!passes_by(in.peek(i)) || !way_of(d, in.peek(i)).has_place()) continue;
    in.bring_forward(i);
    return true;
  }
  return false;
}

/// Brings the packet that dispatch takes next to the front, if it can take one.
bool Dispatcher::choose_to_handle(std::size_t d, Cycle now) {
  InPort& in = in_[d];
  const std::size_t end = passed_over_[d] >= window_ ? 1 : seen(d, now);
  std::size_t chosen = rule_ != nullptr ? ask_rule(d, end) : end;
  for (std::size_t i = 0; i < end && rule_ == nullptr; ++i) {
    const Token& token = in.peek(i);
    const std::optional<Decision> decision = decide(d, token);
    if (!decision || !may_take(*decision)) continue;
    const bool waits = waits_for_shapes(*decision, token);
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
  const SliceKind kind = in.front().answers ? SliceKind::kRetire : SliceKind::kPass;  // others may still be testing it
  parts_.dispatch.hold(now, 1, 0, kind, in.front().packet, !in.front().passes);
  return true;
}

/// The choice of a plugin among the first packets of a queue; `end` if none of them may go.
std::size_t Dispatcher::ask_rule(std::size_t d, std::size_t end) {
  waiting_.clear();
  bool any = false;
  for (std::size_t i = 0; i < end; ++i) {
    const Token& token = in_[d].peek(i);
    const std::optional<Decision> decision = decide(d, token);
    WaitingPacket& one = waiting_.emplace_back();
    one.rays = token.rays;
    if (decision && decision->action == Action::kHear) {  // its owner, on another thread, may be issuing it anew
      one.may_go = one.has_shapes = any = true;
      continue;
    }
    const Packet& packet = parts_.machine.packet(token.packet);
    one.depth = packet.depth;
    one.own = packet.owner == id();
    if (!decision) continue;
    one.may_go = may_take(*decision);
    one.tests = decision->action == Action::kTest || decision->action == Action::kTestOwn;
    one.has_shapes = !waits_for_shapes(*decision, token);
    any = any || one.may_go;
  }
  if (!any) return end;
  const std::size_t chosen = rule_->choose(waiting_);
  if (chosen >= end || !waiting_[chosen].may_go)
    throw SimulationError(fmt::format("testers.dispatch: {} chose packet {} of {}, {}", rule_name_, chosen, end,
                                      chosen < end ? "which cannot go on" : "which is none"));
  return chosen;
}

bool Dispatcher::waits_for_shapes(const Decision& decision, const Token& token) const {
  const bool tests = decision.action == Action::kTest || decision.action == Action::kTestOwn;
  if (!fetch_by_resource_ || !tests) return false;
  const Packet& packet = parts_.machine.packet(token.packet);
  return !parts_.needs.is_treelet(packet) && !parts_.shapes.has(parts_.needs.shapes(packet, false)[0]);
}

}  // namespace carousel::ringbus::cycle
