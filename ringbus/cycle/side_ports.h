#pragma once

#include "ringbus/cycle/channel.h"
#include "ringbus/cycle/control_messages.h"
#include "ringbus/cycle/memory_messages.h"

namespace carousel::ringbus::cycle {

/// A resource's channels beside the links: from ray control, to shading, and to its cache and back.
struct SidePorts {
  Channel<NewRays>* new_rays = nullptr;
  Channel<CompletedRays>* completed = nullptr;
  Channel<FetchRequest>* fetch = nullptr;
  Channel<FetchAnswer>* fetched = nullptr;
};

}  // namespace carousel::ringbus::cycle
