#pragma once

#include <string>
#include <vector>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/tile/records/id_census.h"
#include "ringbus/packets/statistics_sink.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/energy_events.h"
#include "ringbus/results/trace.h"
#include "ringbus/time/agent.h"

namespace carousel::ringbus::cycle {

class ShapeBuffer;

/// The engine's view of a resource, with or without packets.
class ResourceAgent : public Agent {
 public:
  /// The last cycle in which it did anything; passing a packet on at once does not count, as it arrives elsewhere.
  virtual Cycle last_event() const = 0;
  /// Ends the time that is accounted to states; once, and not before last_event().
  virtual void close(Cycle end) = 0;
  /// After close().
  virtual TileResult result() const = 0;
  /// How long its parts have been busy so far, as in result(), and what they did for which energy is counted.
  struct Work {
    PerUnit<Cycle> units{};
    Cycle ray_reads = 0, dispatch = 0;
    EnergyEvents::OfResource energy{};
    const DistributorCounts* distributor = nullptr;  ///< null: there is none
  };
  virtual Work work() const = 0;
  virtual ResourceStatistics statistics() const = 0;
  virtual CollectionStore::Statistics collections() const = 0;
  virtual ShapeBuffer& shape_buffer() = 0;
  /// The IDs in its collections over time; null where there are none. After close().
  virtual const IdCensus* census() const { return nullptr; }
  /// Packets of its own that were discarded because a resource had stopped.
  virtual std::uint64_t packets_discarded() const { return 0; }

  /// The near ends of its links, by port.
  virtual const std::vector<OutPort>& out() const = 0;
  /// The packet that cannot leave by a port, with its first ray; or empty.
  virtual std::string blocked(std::size_t port) const = 0;
  virtual const Trace& trace() const = 0;
  /// Its counters over time (resource_samples.h). After close().
  virtual const CounterSamples& samples() const = 0;
};

}  // namespace carousel::ringbus::cycle
