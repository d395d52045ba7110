#pragma once

#include "ringbus/cycle/messages/any_hit_messages.h"
#include "ringbus/cycle/messages/control_messages.h"
#include "ringbus/cycle/messages/help_messages.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/time/channel.h"

namespace carousel::ringbus::cycle {

/// A resource's channels beside the links: from ray control, to shading, to its cache and back; and with
/// `idle_resources_shade` for jobs from shading, and what it has to say of them; with `any_hit: shader` for what lets
/// rays through.
struct SidePorts {
  Channel<NewRays>* new_rays = nullptr;
  Channel<CompletedRays>* completed = nullptr;
  Channel<FetchRequest>* fetch = nullptr;
  Channel<FetchAnswer>* fetched = nullptr;
  Channel<ShadeJob>* jobs = nullptr;  ///< null, like `help`, when it does not help
  Channel<HelpNote>* help = nullptr;
  Channel<AnyHitQuestion>* questions = nullptr;  ///< null, like `answers`, where resources know themselves
  Channel<AnyHitAnswer>* answers = nullptr;
};

}  // namespace carousel::ringbus::cycle
