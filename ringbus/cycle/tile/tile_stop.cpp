// The behaviour of a resource when one has stopped, itself or another.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

/// Stops this resource. Ray control learns only after some time that it is silent (ShadingAgent).
void Tile::stop(Cycle now) {
  stops_ = false;
  logic_.stop();
  discard_work(now);
  help_.stop();
  completed_port_.notify(CompletedRays::Note::kLastBeat, now);
}

void Tile::on_order(NewRays::Order order, Cycle now) {
  if (order == NewRays::Order::kDiscard) {
    logic_.drain();
    discard_work(now);
    return;
  }
  told_drained_ = false;
  logic_.resume(ResourceId(static_cast<std::uint32_t>(fault_.number)));
}

/// Discards all work of this resource. Packets of others that are in test here go on as they are.
void Tile::discard_work(Cycle now) {
  discarded_ += resource_.discard();
  resource_.spills() = {};
  logic_.admission.clear();
  storage_full_ = false;
  for (const Issue& issue : issue_) logic_.discard(issue.packet);
  issue_.clear();
  shapes_.clear_queue(now);
  for (Context& context : contexts_) {
    if ((phases_.in(ContextPhase::kFree) >> user_of(context) & 1) != 0) continue;
    if (context.subtree) visits_.drop(user_of(context), now);
    shapes_.release(user_of(context), now);
    const PacketId id = context.packet;
    const Packet& packet = machine_.packet(id);
    if (packet.owner != id_) {
      depart(id, now, true);
    } else {
      if (logic_.leaves_after_test(packet)) out_for(packet).release();
      discard_at_owner(id);
    }
    context = Context{};
    enter(context, ContextPhase::kFree);
  }
  done_slots_
      .clear();  // of bundles, which wait for a ray to go with; ray control has all slots back when it begins anew
  in_test_.clear();
  shapes_.ready().clear();  // their packets are gone
  visits_.others().clear();
}

void Tile::discard_at_owner(PacketId id) {
  trips_.forget(now_);
  logic_.discard(id);
}

/// Nothing of its own is under way. Packets of others that are here count for their owners.
bool Tile::drained() const {
  return logic_.all_home() && shapes_.fetches() == 0 && spills_out_ == 0 && questions_out_ == 0;
}

}  // namespace carousel::ringbus::cycle
