#pragma once

#include <cstddef>
#include <utility>

#include "ringbus/cycle/tile/records/id_census.h"
#include "ringbus/resource/resource.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// How full a resource's collections have been, and all its counters at regular times.
class TileSamples {
 public:
  /// Keeps a reference. `most` and `counters` as in CounterSamples.
  TileSamples(const CollectionStore& collections, std::size_t most, std::size_t counters)
      : store_(collections), samples_(most, counters) {}

  bool due(Cycle now) const { return samples_.due(now); }
  /// Takes in how things have been since the last step. `read(time, row)` reads the counters.
  template <class Read>
  void until(Cycle now, const Read& read) {
    if (due(now)) [[unlikely]]
      samples_.until(now, read);
    ids_.hold(now, store_.memberships());
    collections_.hold(now, store_.collections());
  }
  /// The same for the numbers of one time in all resources.
  void count_ids(Cycle now) { census_.until(now, store_.memberships()); }
  template <class Read>
  void close(Cycle end, const Read& read) {
    samples_.close(end, read);
    count_ids(end);
  }

  std::uint64_t ids_before(Cycle at) const { return ids_.at(at, store_.memberships()); }  ///< times cycles
  std::uint64_t collections_before(Cycle at) const { return collections_.at(at, store_.collections()); }
  const CounterSamples& counters() const { return samples_; }
  const IdCensus& census() const { return census_; }

 private:
  const CollectionStore& store_;
  CounterSamples samples_;
  LevelSum ids_, collections_;  // over time
  IdCensus census_;
};

}  // namespace carousel::ringbus::cycle
