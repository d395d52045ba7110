#pragma once

#include <algorithm>
#include <vector>

#include "core/config/fields/topology.h"
#include "ringbus/cycle/messages/any_hit_messages.h"
#include "ringbus/cycle/messages/control_messages.h"
#include "ringbus/cycle/messages/help_messages.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// Latency of the wires between a resource and ray control or shading, which are as long as a hop.
inline Cycle control_latency(const LinkConfig& link) {
  return std::max<Cycle>(1, static_cast<Cycle>(link.latency_cycles));
}

/// A resource's channels beside the links: from ray control, to shading, to its cache and back; with
/// `shading.idle_resources_shade` also for jobs from shading and notes about them, and with `testers.any_hit: shader`
/// for any-hit calls and their answers.
struct SidePorts {
  Channel<NewRays>* new_rays = nullptr;
  Channel<CompletedRays>* completed = nullptr;
  Channel<FetchRequest>* fetch = nullptr;
  Channel<FetchAnswer>* fetched = nullptr;
  Channel<ShadeJob>* jobs = nullptr;  ///< null, like `help`, when the resource does not help
  Channel<HelpNote>* help = nullptr;
  Channel<AnyHitQuestion>* questions = nullptr;  ///< null, like `answers`, with `any_hit: inline`
  Channel<AnyHitAnswer>* answers = nullptr;
  Channel<PushedShapes>* pushed = nullptr;   ///< from its cache; null unless `memory.fetch: multicast`
  std::vector<Channel<ShapeHint>*> hints{};  ///< to parts that hear of its requests for shapes
};

}  // namespace carousel::ringbus::cycle
