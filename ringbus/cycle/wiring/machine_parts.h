#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/parts.h"
#include "ringbus/cycle/parts/attached_part.h"
#include "ringbus/cycle/wiring/agent_numbers.h"

namespace carousel::ringbus::cycle {

/// The parts of a machine that declare themselves and are built, each at every L2.
class MachineParts {
 public:
  MachineParts(ChannelList& list, const AgentNumbers& numbers, const PartKeys<Parts>& keys, const MemoryConfig& memory,
               const LinkConfig& link, std::size_t resources);

  /// The channels to parts that hear of this resource's requests for shapes.
  const std::vector<Channel<ShapeHint>*>& hints_of(std::size_t resource) const { return hints_[resource]; }
  /// The channels on which parts ask an L2 for lines ahead.
  const std::vector<Channel<FetchRequest>*>& ahead_at(std::size_t l2) const { return ahead_[l2]; }
  /// In the order of their numbers.
  const std::vector<Agent*>& agents() const { return agents_; }
  /// Those of each part, all L2s together.
  PartCounts<Parts> counts() const;

 private:
  template <class P>
  using Attached = std::vector<AttachedPart<typename P::Counts>>;

  Parts::Tuple<Attached> attached_;  // by L2; empty if it is not built
  std::vector<std::vector<Channel<ShapeHint>*>> hints_;
  std::vector<std::vector<Channel<FetchRequest>*>> ahead_;
  std::vector<Agent*> agents_;
};

}  // namespace carousel::ringbus::cycle
