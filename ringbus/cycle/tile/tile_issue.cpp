// The start of a packet: from a ready collection to the issue queue, where it waits for its shapes, and to dispatch.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

bool Tile::may_inject(const Packet& packet) const {
  const OutPort& out = ports_.out[logic_.out_port(packet)];
  return machine_.flow.may_inject(out.has_place(), [&] { return out.spare_places(); });
}

bool Tile::handle_issue(Cycle now) {
  if (issue_.empty() || !issue_.front().ready()) return false;
  const PacketId id = issue_.front().packet;
  Packet& packet = machine_.packet(id);
  const bool travels = logic_.travels(packet);
  if (travels && !may_inject(packet)) return false;
  const bool tested = logic_.has_rays_of(packet);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  issue_.pop_front();
  trips_.inject(id.value, now);
  trace_.note(now, StepKind::kIssue, id.value, packet.members.size());
  occupy_dispatch(now, packet.members.size());
  if (tested) {
    if (travels) out_for(packet).reserve();
    begin_test(*context, id, dispatch_free_);
    return true;
  }
  if (packet.kind == PacketKind::kTest) {
    ++passed_;
    passed_rays_ += packet.members.size();
  }
  depart(id, dispatch_free_, false);
  return true;
}

bool Tile::nothing_else_to_do(Cycle now) const {
  return issue_.empty() && dispatch_free_ <= now && testers_free() && !help_.holds() &&
         std::none_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now; });
}

Cycle Tile::work_ahead_ends(Cycle now) const {
  Cycle ends = std::max(dispatch_free_, now);
  for (const Issue& issue : issue_) ends += dispatch_cycles(machine_.packet(issue.packet).members.size());
  for (const Context& context : contexts_)
    if (context.phase == Context::Phase::kComputing) ends = std::max(ends, context.done);
  return ends;
}

Cycle Tile::partial_may_go(Cycle now) const {
  switch (partial_) {
    case Partial::kIdle:
      return nothing_else_to_do(now) ? now : kNever;
    case Partial::kAhead: {
      if (help_.holds()) return kNever;
      const Cycle ends = work_ahead_ends(now);
      return ends <= now + memory_latency_ ? now : ends - memory_latency_;
    }
    case Partial::kAfter:  // it becomes ready by itself
      break;
  }
  return kNever;
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
    Issue issue{*id, next_tag_};
    const bool brings_shapes =
        packet.kind == PacketKind::kTest && !fetch_by_resource_ && !resource_.is_treelet(packet.key);
    if (brings_shapes) {
      // The issuer cannot know whether all rays have their copies, so it brings the transform in any case.
      for (const ShapeSpan& span : shape_data(packet.key, true)) {
        if (!lacks(span)) continue;
        fetch(span, issue.tag, now);
        ++issue.outstanding;
      }
      next_tag_ = (next_tag_ + 1) & ~kContextTag;
    }
    issue_.push_back(issue);
  }
  return moved;
}

}  // namespace carousel::ringbus::cycle
