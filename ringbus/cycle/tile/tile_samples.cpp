// The counters of a resource over time.
#include <algorithm>

#include "ringbus/cycle/tile/tile.h"

namespace carousel::ringbus::cycle {

/// Takes in how things have been since the last step.
void Tile::sample(Cycle now) {
  if (samples_.due(now)) [[unlikely]]
    samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  ids_.hold(now, resource_.collections().memberships());
  collections_.hold(now, resource_.collections().collections());
}

void Tile::read(Cycle at, std::span<std::uint64_t> row) {
  const auto put = [&](ResourceCounter counter, std::uint64_t value) { row[counter_index(counter)] = value; };
  read_units(tester_, at, row);
  put(ResourceCounter::kDispatch,
      dispatch_busy_ - (dispatch_ends_ > at ? dispatch_ends_ - std::max(at, dispatch_since_) : 0));
  put(ResourceCounter::kIds, ids_.at(at, resource_.collections().memberships()));
  put(ResourceCounter::kCollections, collections_.at(at, resource_.collections().collections()));
  put(ResourceCounter::kPackets, trips_.packet_cycles(at));
  put(ResourceCounter::kCompleted, sink_.statistics().rays_completed);
  put(ResourceCounter::kTested, sink_.statistics().local_rays);
  put(ResourceCounter::kHeld, travelling_.held(at));
  read_ports(ports_.out, at, kFirstPortCounter, row);
}

void Tile::close(Cycle end) {
  samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  note_blocked(end);
  ledger_.close(end);
  census_.until(end, resource_.collections().memberships());
  tester_.close(end);
  // The dispatch stage may still look through the IDs of the last packet.
  if (dispatch_ends_ > end) dispatch_busy_ -= dispatch_ends_ - std::max(end, dispatch_since_);
}

}  // namespace carousel::ringbus::cycle
