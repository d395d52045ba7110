// The behaviour of ray control and shading when a resource has stopped.
#include "core/system/error.h"
#include "ringbus/cycle/shading/shading_agent.h"
#include "ringbus/faults/unfinished_rays.h"

namespace carousel::ringbus::cycle {

void ShadingAgent::on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now) {
  if (note == CompletedRays::Note::kLastBeat) {
    stop_ = {resource, now - latency_, 0, 0};
    give_up_at_ = now + static_cast<Cycle>(fault_.silence_cycles);
  } else if (--draining_ == 0) {
    restart(now);
  }
}

void ShadingAgent::give_up(Cycle now) {
  give_up_at_ = kNever;
  stop_->noticed = now;
  const ResourceId stopped(stop_->resource);
  if (!fault_.recover) throw SimulationError(unfinished_rays(stopped, ledger_->open(), completed_));
  if (const std::optional<RayResult> ray = helpers_.exclude(clients_[stopped.value].jobs)) to_be_shaded(*ray, now);
  draining_ = clients_.size();
  order_all(NewRays::Order::kDiscard, now);
}

/// Begins again, when no packet is under way and no resource holds an ID.
void ShadingAgent::restart(Cycle now) {
  stop_->restarted = now;
  machine_.control.discard();
  for (Level& held : held_) held.clear(now);
  machine_.control.exclude(ResourceId(stop_->resource));
  slots_ -= machine_.stores.front()->slots();
  order_all(NewRays::Order::kGoOn, now);
  const RayBatch rays = ledger_->open();
  rays_restarted_ = rays.size();
  paths_restarted_ = OutstandingRays::paths_of(rays);
  if (rays.empty()) return;
  if (bundled_) builder_free_ = std::max(builder_free_, now) + ceil_div(rays.size(), builder_rate_);
  machine_.control.submit(rays);
  send_groups(now);
}

/// Sends an order to all resources, behind the rays that were sent before it.
void ShadingAgent::order_all(NewRays::Order order, Cycle now) {
  for (std::uint32_t r = 0; r < clients_.size(); ++r) {
    const NewRays message{{}, order, 0};
    clients_[r].new_rays->send(id_wires_[r].send(message.bytes(), now), message);
  }
}

}  // namespace carousel::ringbus::cycle
