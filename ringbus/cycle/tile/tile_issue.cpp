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

bool Tile::fill_issue(Cycle now) {
  bool moved = false;
  while (issue_.size() < issue_places_ && !resource_.idle()) {
    // Collections that are not full are issued only when there is nothing better to do: waiting fills them.
    const bool nothing_else =
        issue_.empty() && dispatch_free_ <= now && testers_free() && !help_.holds() &&
        std::none_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now; });
    const std::optional<PacketId> id = logic_.free.front();
    if (!id) return moved;
    Packet& packet = machine_.packet(*id);
    const Resource::Offer offer = resource_.offer(nothing_else, packet);
    storage_full_ = offer == Resource::Offer::kStorage;
    if (offer != Resource::Offer::kPacket) return moved;
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
