#pragma once

#include "ringbus/stress/trial.h"
#include "ringbus/stress/worker_group.h"

namespace carousel::ringbus::stress {

// The kinds of trial behind run_trial(): producers and consumers; two threads that answer each other; a ring.
template <std::size_t kBytes>
TrialResult run_stream(const QueueUnderTest& queue, const TrialOptions& options);
template <std::size_t kBytes>
TrialResult run_ping_pong(const QueueUnderTest& queue, const TrialOptions& options);
template <std::size_t kBytes>
TrialResult run_circulation(const QueueUnderTest& queue, const TrialOptions& options);

/// Adds the reason if a group of threads did not end normally.
void note_ending(Violations& violations, WorkerGroup::Ending ending, const TrialOptions& options);

}  // namespace carousel::ringbus::stress
