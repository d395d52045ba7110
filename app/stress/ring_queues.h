#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "app/run/prepare.h"
#include "core/statistics/queue_use.h"
#include "report/stress/stress.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// A queue of a machine of the native engine whose design can be chosen.
struct RingPlace {
  std::string_view key;        ///< key of the queues' design
  std::string_view depth_key;  ///< key of the number of places in one queue
  void (*choose)(Config& config, QueueKind kind, std::int64_t depth);
  std::int64_t (*depth)(const Config& config);
  /// The traffic of the queues of this place in a run.
  QueueUse (*use)(const ringbus::RunResult& result);
};
std::span<const RingPlace> ring_places();

/// How to try queues inside a ring.
struct RingTrial {
  const RingPlace& place;
  std::vector<QueueKind> kinds;
  std::vector<std::int64_t> depths;
  std::size_t repetitions = 3;  ///< runs of every kind and depth
  std::size_t pairs = 12;       ///< pairs of runs of the best and the worst of its depth by these repetitions
  std::stop_token stop{};
  std::function<void(double part)> progress{};
};

struct RingTrialResult {
  std::vector<report::StressRingRow> rows;  ///< by kind, then depth
  std::optional<report::StressPairs> pairs;
};

/// Runs the ring of a prepared configuration on the native engine with each kind of queue at each depth, repetition by
/// repetition and in turn. The best and the worst of its depth by the medians, or of one kind the best and the worst
/// depth, then run in pairs, each of them first in every other
/// pair: medians of few runs, picked out of many, differ by chance.
RingTrialResult try_in_ring(const Prepared& prepared, const RingTrial& trial);

/// A sentence that says whether the pairs show a difference, and which.
std::string ring_verdict(const report::StressPairs& pairs);

}  // namespace carousel::app
