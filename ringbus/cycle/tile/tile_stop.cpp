// What a resource does when one has stopped, itself or another.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

/// That it is silent from now on is known to ray control only after a time (ShadingAgent).
void Tile::stop(Cycle now) {
  stops_ = false;
  stopped_ = true;
  discard_work(now);
  help_.stop();
  completed_port_.notify(CompletedRays::Note::kLastBeat, now);
}

void Tile::on_order(NewRays::Order order, Cycle now) {
  if (order == NewRays::Order::kDiscard) {
    drains_ = true;
    discard_work(now);
    return;
  }
  drains_ = told_drained_ = false;
  resource_.exclude(ResourceId(static_cast<std::uint32_t>(machine_.config.faults.resource.number)));
}

/// Whatever it was at. What is in test here and belongs to others goes on to them as it is.
void Tile::discard_work(Cycle now) {
  discarded_ += resource_.discard();
  waiting_.clear();
  storage_full_ = false;
  for (const Issue& issue : issue_) free_[machine_.packet(issue.packet).direction].push_back(issue.packet);
  issue_.clear();
  for (Context& context : contexts_) {
    if (context.phase == Context::Phase::kFree) continue;
    const PacketId id = context.packet;
    const Packet& packet = machine_.packet(id);
    if (packet.owner != id_) {
      depart(id, now, true);
    } else {
      if (!stays_ && machine_.topology.hops(packet) > 0) ports_.out[out_port_of(packet)].release();
      discard_home(id);
    }
    context = Context{};
  }
}

void Tile::discard_home(PacketId id) {
  trips_.forget(now_);
  free_[machine_.packet(id).direction].push_back(id);
}

/// Packets of others that are here are waited for by those.
bool Tile::drained() const {
  std::size_t home = 0;
  for (const std::vector<PacketId>& free : free_) home += free.size();
  return home == free_.size() * machine_.packets_per_direction() && fetches_out_ == 0 && questions_out_ == 0;
}

}  // namespace carousel::ringbus::cycle
