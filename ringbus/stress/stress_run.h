#pragma once

#include <functional>
#include <span>
#include <vector>

#include "ringbus/stress/trial.h"

namespace carousel::ringbus::stress {

struct StressOptions {
  std::vector<Pattern> patterns;           ///< empty: all
  std::vector<std::size_t> message_bytes;  ///< empty: all sizes for streams, 64 for the others
  std::size_t repetitions = 3;
  double seconds = 30;                 ///< about, in all; shared out over the trials
  std::uint64_t messages = 1'000'000;  ///< most messages of a trial
  std::size_t capacity = 64;
  std::uint64_t seed = 1;
  std::chrono::milliseconds stuck_after{2000};
  std::stop_token stop{};
  std::function<void(double part)> progress{};  ///< may be empty
};

/// A queue under a pattern, over all repetitions.
struct StressRow {
  std::size_t queue = 0;  ///< index of the queue
  Pattern pattern{};
  std::size_t message_bytes = 0;
  std::vector<double> rates;  ///< messages per second, a repetition each
  TrialResult sum;            ///< counts and histograms are added; fairness is the least, memory the most

  double median() const;
  double least() const;
  double most() const;
};

/// Tries every queue under every pattern that it fits. Within a repetition the queues take turns, and each repetition
/// begins with another one, so that other load on the machine falls on all of them. Rows are sorted by pattern, size
/// and queue.
std::vector<StressRow> run_stress(std::span<const QueueUnderTest> queues, const StressOptions& options);

}  // namespace carousel::ringbus::stress
