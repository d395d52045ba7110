#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "app/run/prepare.h"
#include "report/stress/stress.h"

namespace carousel::app {

/// Runs the ring of a prepared configuration on the native engine with each kind of queue at each depth, repetition by
/// repetition and in turn. Rows by kind, then depth.
std::vector<report::StressRingRow> try_in_ring(const Prepared& prepared, const std::vector<QueueKind>& kinds,
                                               const std::vector<std::int64_t>& depths, std::size_t repetitions,
                                               std::stop_token stop, const std::function<void(double part)>& progress);

/// A sentence that compares queues and depths, with the spread of the repetitions.
std::string ring_verdict(const std::vector<report::StressRingRow>& rows);

}  // namespace carousel::app
