// A packet's start: from a ready collection by the issue queue, where it waits for its shapes, to the handler.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

bool Tile::may_inject(const Packet& packet) const {
  const OutPort& out = ports_.out[out_port_of(packet)];
  // The bubble rule also leaves a place for the ring's own traffic.
  return out.has_place() && (!bubble_ || machine_.topology.direct() || out.spare_places() >= 2);
}

bool Tile::handle_issue(Cycle now) {
  if (issue_.empty() || !issue_.front().ready()) return false;
  const PacketId id = issue_.front().packet;
  Packet& packet = machine_.packet(id);
  const bool travels = !stays_ && machine_.topology.hops(packet) > 0;
  if (travels && !may_inject(packet)) return false;
  const bool tested = packet.kind == PacketKind::kTest && machine_.topology.wanted(packet, id_);
  Context* context = tested ? free_context() : nullptr;
  if (tested && context == nullptr) return false;
  issue_.pop_front();
  trips_.inject(id.value, now);
  trace_.note(now, StepKind::kIssue, id.value, packet.members.size());
  occupy_dispatch(now, packet.members.size());
  if (tested) {
    if (travels) ports_.out[out_port_of(packet)].reserve();
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

std::optional<PacketId> Tile::free_packet() {
  const std::size_t directions = free_.size();
  for (std::size_t i = 0; i < directions; ++i) {
    // Asked at every step: no division.
    const std::size_t d = next_direction_ + i < directions ? next_direction_ + i : next_direction_ + i - directions;
    if (free_[d].empty()) continue;
    const PacketId id = free_[d].back();
    free_[d].pop_back();
    next_direction_ = d + 1 < directions ? d + 1 : 0;
    return id;
  }
  return std::nullopt;
}

bool Tile::fill_issue(Cycle now) {
  bool moved = false;
  while (issue_.size() < issue_places_ && !resource_.idle()) {
    // Collections that are not full go only when there is nothing better to do: waiting fills them.
    const bool nothing_else =
        issue_.empty() && dispatch_free_ <= now && testers_free() && !help_.holds() &&
        std::none_of(ports_.in.begin(), ports_.in.end(), [&](const InPort& in) { return in.next() <= now; });
    const std::optional<PacketId> id = free_packet();
    if (!id) return moved;
    Packet& packet = machine_.packet(*id);
    const Resource::Offer offer = resource_.offer(nothing_else, packet);
    storage_full_ = offer == Resource::Offer::kStorage;
    if (offer != Resource::Offer::kPacket) {
      free_[packet.direction].push_back(*id);
      return moved;
    }
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
