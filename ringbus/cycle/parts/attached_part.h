#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/config/fields/topology.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/channel.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// The agent of a part, with the counts of its own.
template <class Counts>
class CountingAgent : public Agent {
 public:
  virtual const Counts& counts() const = 0;
};

/// A part that is attached to the machine at one L2. The agent owns its channels; these are the ends that others need.
template <class Counts>
struct AttachedPart {
  std::unique_ptr<CountingAgent<Counts>> agent{};
  std::vector<Channel<ShapeHint>*> hints{};  ///< by resource behind the L2; empty if it does not hear of requests
  Channel<FetchRequest>* ahead = nullptr;    ///< requests for lines ahead; null if it asks its L2 for none
};

/// The place of a part in the machine. Agents are named by their numbers.
struct PartSite {
  std::uint32_t agent = 0, l2 = 0;
  std::vector<std::uint32_t> resources{};  ///< those behind the L2
};

/// The places of all parts of one kind, by L2, and what they share. A part adds its kinds of messages to the list once,
/// and makes its channels from places in it, so that they are counted.
struct PartSites {
  ChannelList& list;
  const MemoryConfig& memory;
  const LinkConfig& link;
  std::vector<PartSite> at;
};

// Each part has a function beside its agent that makes it, if it is built:
//   std::vector<AttachedPart<Counts>> attach(const Keys& keys, const PartSites& sites);
// ringbus/cycle/wiring/machine_parts.cpp includes its header.

}  // namespace carousel::ringbus::cycle
