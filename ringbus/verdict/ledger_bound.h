#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

// What a class of parts may gain at most, by the counters of the run alone.

/// The part of the run's time in which the parts of a class were busy, in the mean; 1 if nobody counts that.
inline double busy(const cycle::CycleResult& run, std::string_view part) {
  for (const cycle::ClassUse& use : run.uses)
    if (use.name == part) return static_cast<double>(use.busy) / (use.parts * static_cast<double>(run.cycles));
  return 1;
}

/// The part of the run's time in which resources waited for what a class of parts makes shorter, in the mean; 1 if
/// nobody counts that. Warps and the resources of a central machine wait in other ways.
inline double waited(const cycle::CycleResult& run, std::string_view part) {
  using cycle::TileState;
  constexpr std::array<std::string_view, 12> kMemory{
      "memory_latency", "memory_bandwidth", "fetch_ahead", "shape_buffer", "l1_size",  "l1_port",
      "l1_mshrs",       "l2_size",          "l2_port",     "l2_mshrs",     "prefetch", "dram_queue"};
  const bool memory = std::find(kMemory.begin(), kMemory.end(), part) != kMemory.end(),
             credits = part == "packets_in_flight", storage = part == "collection_storage",
             latency = part == "test_latency";
  if (run.tiles.empty() || (!memory && !credits && !storage && !latency)) return 1;
  Cycle sum = 0;
  for (const cycle::TileResult& tile : run.tiles) {
    if (tile.warps || tile.distributor) return 1;
    sum += latency ? tile.testing.latency
                   : tile.states[static_cast<std::size_t>(memory    ? TileState::kMemory
                                                          : credits ? TileState::kCredits
                                                                    : TileState::kStorage)];
  }
  return static_cast<double>(sum) / (static_cast<double>(run.tiles.size()) * static_cast<double>(run.cycles));
}

/// The most that a class may gain. Half of the time that goes with it is saved, or all of it with room for what is
/// fetched again; and one part may have twice the time of the mean. Where a resource waits, others may wait for its
/// rays. Of 363 gains of parts in machines drawn by `script/verdicts --drawn`, one was greater, by half a point.
/// Infinite where nothing of the class is counted.
inline double most_gain(const cycle::CycleResult& run, std::string_view part) {
  constexpr double kSchedule = 0.03, kOthersWait = 1.5;
  const double time = std::min(busy(run, part), kOthersWait * waited(run, part));
  return time >= 0.5 ? std::numeric_limits<double>::infinity() : time / (1 - time) + kSchedule;
}

}  // namespace carousel::ringbus
