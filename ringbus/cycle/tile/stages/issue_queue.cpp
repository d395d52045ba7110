#include "ringbus/cycle/tile/stages/issue_queue.h"

#include <algorithm>
#include <optional>

namespace carousel::ringbus::cycle {

IssueQueue::IssueQueue(const TileParts& parts, const TileSettings& settings, const TestContexts& contexts,
                       const ShadeHelp& help, CollectionRoom& room)
    : parts_(parts),
      contexts_(contexts),
      help_(help),
      room_(room),
      multicast_(settings.memory, parts.resource.id(), parts.machine.topology.resources()),
      partial_(settings.resource.collections.partial),
      memory_latency_(static_cast<Cycle>(settings.memory.l2_latency_cycles + settings.memory.dram_latency_cycles) +
                      settings.way_to_memory),
      fetch_by_resource_(settings.fetches_by_resource()),
      contexts_fetch_(!parts.machine.stays && contexts.starts_later()),
      first_user_(static_cast<ShapeBuffer::User>(settings.testers.contexts)),
      places_(places(settings)) {}

void IssueQueue::take_spilled() {
  if (parts_.shapes.spill_answers().empty()) return;
  for (const std::uint32_t user : parts_.shapes.spill_answers()) {
    room_.take_answer();
    for (Entry& entry : entries_)
      if (entry.user == user && entry.spilled > 0) --entry.spilled;
  }
  parts_.shapes.spill_answers().clear();
}

/// The end of the tests under way, or of the dispatch of all packets in the queue, if that is later.
Cycle IssueQueue::work_ahead_ends(Cycle now) const {
  Cycle ends = std::max(parts_.dispatch.free_at(), now);
  for (const Entry& entry : entries_)
    ends += parts_.dispatch.cycles(parts_.machine.packet(entry.packet).members.size());
  return std::max(ends, contexts_.last_end());
}

/// The time from which a collection that is not ready may go.
Cycle IssueQueue::partial_may_go(Cycle now, bool links_rest) const {
  switch (partial_) {
    case Partial::kIdle: {
      const bool rests =
          entries_.empty() && parts_.dispatch.free_at() <= now && contexts_.all_free() && !help_.holds() && links_rest;
      return rests ? now : kNever;
    }
    case Partial::kAhead: {
      if (help_.holds()) return kNever;
      // Where a packet waits in contexts for its shapes, more packets than free contexts only wait in line, and fewer
      // rays share a wait.
      if (contexts_fetch_ && entries_.size() >= contexts_.free()) return kNever;
      const Cycle ends = work_ahead_ends(now);
      return ends <= now + memory_latency_ ? now : ends - memory_latency_;
    }
    case Partial::kAfter:  // it becomes ready by itself
      break;
  }
  return kNever;
}

/// Tells whether a packet waits in the queue for its shapes: to bring them along, or because it will be tested here
/// before it leaves.
bool IssueQueue::fetches_ahead(const Packet& packet) const {
  if (packet.kind != PacketKind::kTest) return false;
  return (!fetch_by_resource_ && !parts_.needs.is_treelet(packet)) ||
         (parts_.logic.has_rays_of(packet) && !parts_.logic.tests_own_last(packet));
}

bool IssueQueue::fill(Cycle now, bool links_rest) {
  bool moved = false;
  next_partial_ = kNever;
  while (!full() && !parts_.resource.idle()) {
    const std::optional<PacketId> id = parts_.logic.free.front();
    if (!id) return moved;
    const Cycle partial_at = partial_may_go(now, links_rest);
    Packet& packet = parts_.machine.packet(*id);
    const Resource::Offer offer = parts_.resource.offer(partial_at <= now, packet);
    room_.set_short_of_room(offer == Resource::Offer::kStorage);
    if (offer != Resource::Offer::kPacket) {
      next_partial_ = partial_at;
      return moved;
    }
    parts_.logic.free.take();
    moved = true;
    parts_.recorder.issued(*id, now);
    Entry entry{*id, static_cast<ShapeBuffer::User>(first_user_ + issued_++ % places_)};
    entry.takes_data = fetches_ahead(packet);
    // The issuer cannot know whether all rays have their copies, so it takes the transform in any case.
    if (entry.takes_data)
      parts_.shapes.take_ahead(entry.user, parts_.needs.shapes(packet, true), now,
                               multicast_.others(parts_.machine.topology, packet));
    entry.spilled = room_.read_spilled(entry.user, now);
    entries_.push_back(entry);
  }
  return moved;
}

void IssueQueue::discard(Cycle now) {
  for (const Entry& entry : entries_) parts_.logic.discard(entry.packet);
  entries_.clear();
  parts_.shapes.clear_queue(now);
}

}  // namespace carousel::ringbus::cycle
