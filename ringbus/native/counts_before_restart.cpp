#include "ringbus/native/counts_before_restart.h"

#include "ringbus/faults/outstanding_rays.h"

namespace carousel::ringbus {

void CountsBeforeRestart::keep(const NativeParts& parts) {
  for (const auto& port : parts.ports()) packets_discarded_ += port->resource().packets_in_flight();
  const NativeMachine& machine = parts.machine();
  link_faults_.resize(machine.links.size());
  for (std::size_t i = 0; i < machine.links.size(); ++i) link_faults_[i] += machine.links[i]->faults();
  completed_ += machine.completed.use();
  groups_ += machine.shared.control.groups_sent();
  slots_used_ += machine.shared.control.slots_used();
  slot_waits_ += machine.shared.control.slot_waits();
}

void CountsBeforeRestart::restart(const RayBatch& rays, double seconds) {
  rays_restarted_ += rays.size();
  paths_restarted_ += OutstandingRays::paths_of(rays);
  recovery_seconds_ = seconds;
}

void CountsBeforeRestart::add_to(RunResult& out) const {
  out.rays_restarted = rays_restarted_;
  out.paths_restarted = paths_restarted_;
  out.packets_discarded += packets_discarded_;
  out.recovery_seconds = recovery_seconds_;
  out.slots_used += slots_used_;
  out.slot_waits += slot_waits_;
  out.completed += completed_;
  out.groups += groups_;
  for (std::size_t i = 0; i < link_faults_.size(); ++i) out.links[i].faults += link_faults_[i];
}

}  // namespace carousel::ringbus
