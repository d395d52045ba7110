#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/config/fields/memory.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/parcels/door.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/cycle/wiring/agent_numbers.h"

namespace carousel::ringbus::cycle {

/// The kinds of messages beside the links. Resources that help to shade, any-hit calls and multicast have kinds in
/// every machine or none, as the ledger shows them.
struct SideKinds {
  ControlKinds control;
  FetchKinds fetch;
  AnyHitKinds any_hit;
  HelpKinds help;
  std::optional<MessageKind> pushed{};
};

/// The latencies of the wires beside the links.
struct SideLatencies {
  Cycle control, request, answer;
  SideLatencies(const LinkConfig& link, const MemoryConfig& nearest)
      : control(control_latency(link)),
        request(ShapeCache::request_latency(nearest)),
        answer(ShapeCache::answer_latency(nearest)) {}
};

/// The channels of one resource beside the links. Where a part is drawn, they lead to the links.
class SideChannels {
 public:
  /// `helps`: the resource shades when it has nothing to test; `calls_shader`: it asks shading for any-hit calls. With
  /// a kind of pushed shapes its cache sends it shapes for which others have asked.
  SideChannels(ChannelList& list, const SideKinds& kinds, const SideLatencies& latency, const AgentNumbers& agents,
               std::uint32_t resource, bool helps, bool calls_shader)
      : new_rays_(
            list.at(kinds.control.new_rays,
                    agents.new_rays_drawn
                        ? ChannelEnds{agents.shading(), agents.relay(agents.pool_nodes[resource]), latency.control}
                        : ChannelEnds{agents.shading(), resource, latency.control, true})),
        completed_(list.at(kinds.control.completed,
                           agents.completed_drawn ? ChannelEnds{resource, agents.relay(resource), latency.control}
                                                  : ChannelEnds{resource, agents.shading(), latency.control, true})),
        fetch_(list.at(kinds.fetch.requests, {resource, agents.nearest_cache(resource), latency.request})),
        fetched_(list.at(kinds.fetch.data, {agents.nearest_cache(resource), resource,
                                            agents.asks_over_links() ? kDoorCycles : latency.answer, true})) {
    const ChannelEnds to_shading{resource, agents.shading(), latency.control},
        from_shading{agents.shading(), resource, latency.control, true};
    if (kinds.pushed)
      pushed_ = std::make_unique<Channel<PushedShapes>>(
          list.at(*kinds.pushed, {agents.nearest_cache(resource), resource, latency.answer, true}));
    if (helps) {
      jobs_ = std::make_unique<Channel<ShadeJob>>(list.at(kinds.help.jobs, from_shading));
      notes_ = std::make_unique<Channel<HelpNote>>(list.at(kinds.help.notes, to_shading));
    }
    if (calls_shader) {
      questions_ = std::make_unique<Channel<AnyHitQuestion>>(list.at(kinds.any_hit.questions, to_shading));
      answers_ = std::make_unique<Channel<AnyHitAnswer>>(list.at(kinds.any_hit.answers, from_shading));
    }
  }

  SidePorts ports() {
    return {&new_rays_,   &completed_,      &fetch_,        &fetched_,    jobs_.get(),
            notes_.get(), questions_.get(), answers_.get(), pushed_.get()};
  }

 private:
  Channel<NewRays> new_rays_;
  Channel<CompletedRays> completed_;
  Channel<FetchRequest> fetch_;
  Channel<FetchAnswer> fetched_;
  std::unique_ptr<Channel<PushedShapes>> pushed_;
  std::unique_ptr<Channel<ShadeJob>> jobs_;
  std::unique_ptr<Channel<HelpNote>> notes_;
  std::unique_ptr<Channel<AnyHitQuestion>> questions_;
  std::unique_ptr<Channel<AnyHitAnswer>> answers_;
};

}  // namespace carousel::ringbus::cycle
