#pragma once

#include <cstdint>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/cycle/wiring/agent_numbers.h"

namespace carousel::ringbus::cycle {

/// The channels on which ray control and shading read and write data of rays and paths through one L2.
class RayDataChannels {
 public:
  RayDataChannels(ChannelList& list, const RayDataKinds& kinds, const MemoryConfig& config, const AgentNumbers& agents,
                  std::uint32_t cache)
      : requests_(
            list.at(kinds.requests, {agents.shading(), agents.cache(cache), ShapeCache::request_latency(config)})),
        answers_(list.at(kinds.data, {agents.cache(cache), agents.shading(), ShapeCache::answer_latency(config)})) {}

  SidePorts ports() {
    SidePorts side;
    side.fetch = &requests_;
    side.fetched = &answers_;
    return side;
  }

 private:
  Channel<FetchRequest> requests_;
  Channel<FetchAnswer> answers_;
};

}  // namespace carousel::ringbus::cycle
