#pragma once

#include <memory>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus::cycle {

/// The channels of one resource beside the links.
class SideChannels {
 public:
  /// `helps`: the resource shades when it has nothing to test; `calls_shader`: it asks shading for any-hit calls.
  /// `multicasts`: its cache sends it shapes for which others have asked.
  SideChannels(bool helps, bool calls_shader, bool multicasts) {
    if (multicasts) pushed_ = std::make_unique<Channel<PushedShapes>>();
    if (helps) help_ = std::make_unique<Help>();
    if (calls_shader) any_hit_ = std::make_unique<AnyHit>();
  }

  SidePorts ports() {
    SidePorts side{&new_rays_, &completed_, &fetch_, &fetched_};
    if (help_) {
      side.jobs = &help_->jobs;
      side.help = &help_->notes;
    }
    if (any_hit_) {
      side.questions = &any_hit_->questions;
      side.answers = &any_hit_->answers;
    }
    side.pushed = pushed_.get();
    return side;
  }

  /// Announces arrivals to the agents at either end.
  void connect(WakeupTable& wakeups, const Agent& resource, const Agent& shading, const Agent& cache) {
    wakeups.connect_beside(new_rays_, shading, resource);
    wakeups.connect_beside(completed_, resource, shading);
    wakeups.connect(fetch_, resource, cache);
    wakeups.connect_beside(fetched_, cache, resource);
    if (pushed_) wakeups.connect_beside(*pushed_, cache, resource);
    if (any_hit_) {
      wakeups.connect(any_hit_->questions, resource, shading);
      wakeups.connect_beside(any_hit_->answers, shading, resource);
    }
    if (!help_) return;
    wakeups.connect_beside(help_->jobs, shading, resource);
    wakeups.connect(help_->notes, resource, shading);
  }

 private:
  struct Help {
    Channel<ShadeJob> jobs;
    Channel<HelpNote> notes;
  };
  struct AnyHit {
    Channel<AnyHitQuestion> questions;
    Channel<AnyHitAnswer> answers;
  };

  Channel<NewRays> new_rays_;
  Channel<CompletedRays> completed_;
  Channel<FetchRequest> fetch_;
  Channel<FetchAnswer> fetched_;
  std::unique_ptr<Channel<PushedShapes>> pushed_;
  std::unique_ptr<Help> help_;
  std::unique_ptr<AnyHit> any_hit_;
};

}  // namespace carousel::ringbus::cycle
