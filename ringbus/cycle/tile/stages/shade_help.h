#pragma once

#include <algorithm>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"

namespace carousel::ringbus::cycle {

/// A resource's part in shading (`shading.idle_resources_shade`): it notes when its testers fall idle and when they are
/// needed again, and does a job when it gets one. A job that comes when there are tests again waits for the tests that
/// have begun, and later tests wait for the job: nothing is broken off, so both always end.
///
/// Only the cycles of the job are spent here. The ray itself is shaded by the shading agent, like all others.
class ShadeHelp {
 public:
  ShadeHelp(const LinkConfig& link, const SidePorts& ports)
      : jobs_(ports.jobs), notes_(ports.help), wire_(link, control_latency(link)) {}

  /// Takes a job in, starts it if no test is under way, ends it. Returns whether any of these happened.
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
  /// The resource helps.
  bool on() const { return jobs_ != nullptr; }
  /// Sends a note at the end of a step, if there is anything to note.
  void notify(Cycle now, bool idle) {
    if (jobs_ == nullptr || stopped_ || holds() || (!shaded_ && idle == told_idle_)) return;
    const HelpNote note{shaded_, idle};
    notes_->send(wire_.send(note.bytes(), now), note);
    told_idle_ = idle;
    shaded_ = false;
  }

  /// From now on jobs are thrown away.
  void stop() {
    stopped_ = true;
    waiting_ = shaded_ = false;
    done_ = kNever;
  }

  /// There is a job, so no test may begin.
  bool holds() const { return waiting_ || shading(); }
  bool shading() const { return done_ != kNever; }
  Cycle ends() const { return done_; }  ///< of the job
  Cycle next_job() const { return jobs_ == nullptr ? kNever : jobs_->next(); }

 private:
  Channel<ShadeJob>* jobs_;  // null: the resource does not help
  Channel<HelpNote>* notes_;
  SideWire wire_;
  Cycle cycles_ = 0;  // of the job
  Cycle done_ = kNever;
  bool waiting_ = false, shaded_ = false, stopped_ = false;
  bool told_idle_ = true;  // all resources are idle at first
};

}  // namespace carousel::ringbus::cycle
