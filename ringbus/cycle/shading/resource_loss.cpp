#include "ringbus/cycle/shading/resource_loss.h"

#include "core/system/error.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/faults/unfinished_rays.h"

namespace carousel::ringbus::cycle {

ResourceLoss::ResourceLoss(const FaultsConfig::Resource& fault, const LinkConfig& link)
    : fault_(fault), latency_(control_latency(link)) {
  if (fault_.kind == FaultsConfig::Resource::Kind::kStop) ledger_ = std::make_unique<OutstandingRays>();
}

void ResourceLoss::on_last_beat(std::uint32_t resource, Cycle now) {
  stop_ = {resource, now - latency_, 0, 0};
  give_up_at_ = now + static_cast<Cycle>(fault_.silence_cycles);
}

std::uint32_t ResourceLoss::give_up(std::size_t resources, std::uint64_t completed, Cycle now) {
  give_up_at_ = kNever;
  stop_->noticed = now;
  if (!fault_.recover) throw SimulationError(unfinished_rays(ResourceId(stop_->resource), ledger_->open(), completed));
  draining_ = resources;
  return stop_->resource;
}

RayBatch ResourceLoss::restart(Cycle now) {
  stop_->restarted = now;
  RayBatch rays = ledger_->open();
  rays_restarted_ = rays.size();
  paths_restarted_ = OutstandingRays::paths_of(rays);
  return rays;
}

}  // namespace carousel::ringbus::cycle
