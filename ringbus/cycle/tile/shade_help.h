#pragma once

#include <algorithm>

#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/messages/side_ports.h"

namespace carousel::ringbus::cycle {

/// A resource's part in shading (`shading.idle_resources_shade`): it says when its testers fall idle and when they
/// are needed again, and does a job when it gets one. A job that comes too late, when there are tests again, waits
/// for those that have begun, and the others for it: nothing is broken off, so both always end.
///
/// The job takes its cycles here; what comes of it is known to the shading agent, where everything is shaded.
class ShadeHelp {
 public:
  ShadeHelp(const Config& config, const SidePorts& ports)
      : jobs_(ports.jobs), notes_(ports.help), latency_(control_latency(config)) {}

  /// Takes a job in, starts it if no test is under way, ends it. Whether any of these happened.
  bool step(Cycle now, bool testers_free) {
    if (jobs_ == nullptr) return false;
    if (stopped_) {
      while (jobs_->next() <= now) jobs_->take();
      return false;
    }
    bool moved = false;
    if (jobs_->next() <= now) {
      cycles_ = jobs_->take().cycles;
      waiting_ = moved = true;
    }
    if (waiting_ && testers_free) {
      waiting_ = false;
      done_ = now + cycles_;
      moved = true;
    }
    if (done_ > now) return moved;
    done_ = kNever;
    return shaded_ = true;
  }
  /// At the end of a step: what there is to say, if anything.
  void notify(Cycle now, bool idle) {
    if (jobs_ == nullptr || stopped_ || holds() || (!shaded_ && idle == told_idle_)) return;
    notes_->send(now + latency_, {shaded_, idle});
    told_idle_ = idle;
    shaded_ = false;
  }

  /// From now on jobs come to nothing.
  void stop() {
    stopped_ = true;
    waiting_ = shaded_ = false;
    done_ = kNever;
  }

  /// There is a job, so no test may begin.
  bool holds() const { return waiting_ || shading(); }
  bool shading() const { return done_ != kNever; }
  Cycle next() const { return jobs_ == nullptr ? kNever : std::min(done_, jobs_->next()); }

 private:
  Channel<ShadeJob>* jobs_;  // null: it does not help
  Channel<HelpNote>* notes_;
  Cycle latency_, cycles_ = 0;  // cycles: of the job
  Cycle done_ = kNever;
  bool waiting_ = false, shaded_ = false, stopped_ = false;
  bool told_idle_ = true;  // as everybody is at first
};

}  // namespace carousel::ringbus::cycle
