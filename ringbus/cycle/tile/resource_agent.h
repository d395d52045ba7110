#pragma once

#include <string>
#include <vector>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// A resource, whatever machine it is part of, as the engine sees it.
class ResourceAgent : public Agent {
 public:
  /// Ends the clocks of the ledger.
  virtual void close(Cycle end) = 0;
  /// After close().
  virtual TileResult result() const = 0;
  virtual ResourceStatistics statistics() const = 0;
  virtual CollectionStore::Statistics collections() const = 0;
  /// Packets it had issued that were not waited for, because a resource had stopped.
  virtual std::uint64_t packets_discarded() const { return 0; }

  /// The near ends of its links, as the topology's wires.
  virtual const std::vector<OutPort>& out() const = 0;
  /// The packet that cannot leave by an exit, with the first of its rays, or empty.
  virtual std::string blocked(std::size_t exit) const = 0;
  virtual const Trace& trace() const = 0;
};

}  // namespace carousel::ringbus::cycle
