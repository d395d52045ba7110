// The start of a packet: from a ready collection to the issue queue, where it waits for its shapes, and to dispatch.
#include <algorithm>
#include <bit>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

bool Tile::may_inject(const Packet& packet) {
  const OutPort& out = out_for(packet);
  const bool may = machine_.flow.may_inject(out.has_place(), [&] { return out.spare_places(); });
  waits_for_place_ |= !may;
  return may;
}

bool Tile::handle_issue(Cycle now) {
  if (issue_.empty() || !is_ready(issue_.front())) return false;
  const Issue issue = issue_.front();
  const PacketId id = issue.packet;
  Packet& packet = machine_.packet(id);
  const bool travels = logic_.travels(packet);
  if (travels && !may_inject(packet)) return false;
  const bool own_last = logic_.tests_own_last(packet), tested = !own_last && logic_.has_rays_of(packet);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  issue_.pop_front();
  if (issue.takes_data) shapes_.leave_queue(issue.user);
  trips_.inject(id.value, now);
  trace_.note(now, StepKind::kIssue, id.value, packet.members.size());
  occupy_dispatch(now, packet.members.size(), SliceKind::kIssue, id);
  if (tested) {
    if (travels) out_for(packet).reserve();
    if (issue.takes_data) shapes_.hand_over(issue.user, user_of(*context));
    begin_test(*context, id, dispatch_free_, issue.takes_data);
    return true;
  }
  if (issue.takes_data) shapes_.release(issue.user, now);  // the packet takes them along
  if (packet.kind == PacketKind::kTest && !own_last) {
    ++passed_;
    passed_rays_ += packet.members.size();
  }
  depart(id, dispatch_free_, false);
  return true;
}

// ---- spilled entries

/// Sends the entries that have been spilled to memory. Nothing waits for that.
void Tile::write_spilled(Cycle now) {
  std::vector<SpillMove>& written = resource_.spills().written;
  for (const SpillMove& move : written) shapes_.port().write(spill_memory_.written(move), now);
  written.clear();
}

/// Asks for the entries of a packet that are in memory.
void Tile::read_spilled(Issue& issue, Cycle now) {
  std::vector<SpillMove>& read = resource_.spills().read;
  for (const SpillMove& move : read) {
    shapes_.port().request(spill_memory_.read(move), kSpillTag | issue.user, now);
    ++issue.spilled;
    ++spills_out_;
  }
  read.clear();
}

void Tile::take_spilled() {
  if (shapes_.spill_answers().empty()) return;
  for (const std::uint32_t user : shapes_.spill_answers()) {
    --spills_out_;
    for (Issue& issue : issue_)
      if (issue.user == user && issue.spilled > 0) --issue.spilled;
  }
  shapes_.spill_answers().clear();
}

// ---- from a collection to the issue queue

bool Tile::nothing_else_to_do(Cycle now) const {
  return issue_.empty() && dispatch_free_ <= now && testers_free() && !help_.holds() &&
         std::none_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now; });
}

Cycle Tile::work_ahead_ends(Cycle now) const {
  Cycle ends = std::max(dispatch_free_, now);
  for (const Issue& issue : issue_) ends += dispatch_cycles(machine_.packet(issue.packet).members.size());
  return std::max(ends, phases_.last_end(phases_.in(ContextPhase::kComputing)));
}

Cycle Tile::partial_may_go(Cycle now) const {
  switch (partial_) {
    case Partial::kIdle:
      return nothing_else_to_do(now) ? now : kNever;
    case Partial::kAhead: {
      if (help_.holds()) return kNever;
      // Where a packet waits in contexts for its shapes, more packets than free contexts only wait in line, and fewer
      // rays share a wait.
      if (contexts_fetch_ && issue_.size() >= static_cast<std::size_t>(std::popcount(phases_.in(ContextPhase::kFree))))
        return kNever;
      const Cycle ends = work_ahead_ends(now);
      return ends <= now + memory_latency_ ? now : ends - memory_latency_;
    }
    case Partial::kAfter:  // it becomes ready by itself
      break;
  }
  return kNever;
}

/// Tells whether a packet waits in the issue queue for its shapes: to bring them along, or because it will be tested
/// here before it leaves.
bool Tile::fetches_ahead(const Packet& packet) const {
  if (packet.kind != PacketKind::kTest) return false;
  return (!fetch_by_resource_ && !resource_.is_treelet(packet.key)) ||
         (logic_.has_rays_of(packet) && !logic_.tests_own_last(packet));
}

bool Tile::fill_issue(Cycle now) {
  bool moved = false;
  next_partial_ = kNever;
  while (issue_.size() < issue_places_ && !resource_.idle()) {
    const std::optional<PacketId> id = logic_.free.front();
    if (!id) return moved;
    const Cycle partial_at = partial_may_go(now);
    Packet& packet = machine_.packet(*id);
    const Resource::Offer offer = resource_.offer(partial_at <= now, packet);
    storage_full_ = offer == Resource::Offer::kStorage;
    if (offer != Resource::Offer::kPacket) {
      next_partial_ = partial_at;
      return moved;
    }
    logic_.free.take();
    moved = true;
    if (recording_.slices != nullptr) [[unlikely]]
      note_issued(*id, now);
    Issue issue{*id, static_cast<ShapeBuffer::User>(contexts_.size() + issued_++ % issue_places_)};
    issue.takes_data = fetches_ahead(packet);
    // The issuer cannot know whether all rays have their copies, so it takes the transform in any case.
    if (issue.takes_data)
      shapes_.take_ahead(issue.user, shape_data(packet, true), now, multicast_.others(machine_.topology, packet));
    read_spilled(issue, now);
    issue_.push_back(issue);
  }
  return moved;
}

}  // namespace carousel::ringbus::cycle
