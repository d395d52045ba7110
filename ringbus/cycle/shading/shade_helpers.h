#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The shading agent's side of ShadeHelp: the resources that have nothing to test, as far as it knows, and the rays it
/// has sent them, one each. The resource that fell idle first gets the next ray.
class ShadeHelpers {
 public:
  /// By resource; a resource without a channel for jobs does not help.
  ShadeHelpers(const std::vector<SidePorts>& resources, const LinkConfig& link) {
    for (const SidePorts& ports : resources) {
      if (ports.jobs == nullptr) continue;
      idle_.push_back(helpers_.size());
      helpers_.push_back({ports.jobs, ports.help, SideWire(link, control_latency(link)), false, {}});
    }
  }

  Cycle next() const {
    Cycle first = kNever;
    for (const Helper& helper : helpers_) first = std::min(first, helper.notes->next());
    return first;
  }
  /// Takes notes in; appends the rays that have been shaded to `shaded`.
  void take_notes(Cycle now, HitBatch& shaded) {
    for (std::size_t i = 0; i < helpers_.size(); ++i)
      while (helpers_[i].notes->next() <= now) take(i, helpers_[i].notes->take(), shaded);
  }
  /// Tells whether a resource can take a ray.
  bool any() const { return !idle_.empty(); }
  void give(const RayResult& ray, Cycle cycles, Cycle now) {
    Helper& helper = helpers_[idle_.front()];
    idle_.pop_front();
    helper.ray = ray;
    helper.has_job = true;
    ++out_;
    const ShadeJob job{cycles};
    helper.jobs->send(helper.wire.send(job.bytes(), now), job);
  }
  /// The helper whose jobs go by `jobs` has stopped. Returns the ray it had, if any, to be shaded elsewhere.
  std::optional<RayResult> exclude(const Channel<ShadeJob>* jobs) {
    for (std::size_t i = 0; i < helpers_.size(); ++i) {
      Helper& helper = helpers_[i];
      if (helper.jobs != jobs) continue;
      std::erase(idle_, i);
      if (!std::exchange(helper.has_job, false)) return std::nullopt;
      --out_;
      return helper.ray;
    }
    return std::nullopt;
  }
  /// Rays sent that have not come back.
  std::size_t out() const { return out_; }

 private:
  struct Helper {
    Channel<ShadeJob>* jobs;
    Channel<HelpNote>* notes;
    SideWire wire;  // carries the jobs
    bool has_job;
    RayResult ray;
  };

  void take(std::size_t i, const HelpNote& note, HitBatch& shaded) {
    Helper& helper = helpers_[i];
    // A note that crossed the job. The helper sends another one when it has done the job.
    if (helper.has_job && !note.shaded) return;
    if (note.shaded) {
      shaded.push_back(helper.ray);
      helper.has_job = false;
      --out_;
    }
    if (note.idle)
      idle_.push_back(i);
    else
      std::erase(idle_, i);
  }

  std::vector<Helper> helpers_;
  std::deque<std::size_t> idle_;
  std::size_t out_ = 0;
};

}  // namespace carousel::ringbus::cycle
