#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stop_token>

#include "core/numeric/latency_histogram.h"
#include "ringbus/stress/pattern.h"
#include "ringbus/stress/queue_under_test.h"
#include "ringbus/stress/violations.h"

namespace carousel::ringbus::stress {

/// How one queue is tried once under one pattern.
struct TrialOptions {
  Pattern pattern = Pattern::kStream;
  std::size_t message_bytes = kLine;                               ///< kSmall, kLine or kPacket
  std::size_t capacity = 64;                                       ///< unless the pattern has its own
  std::uint64_t messages = 100'000;                                ///< at most, over all producers
  std::chrono::nanoseconds time = std::chrono::milliseconds(200);  ///< no message is sent later
  std::chrono::milliseconds stuck_after{2000};                     ///< without progress
  std::uint64_t seed = 1;                                          ///< seed of pauses and lengths of batches
  std::stop_token stop{};                                          ///< ends it early
};

struct TrialResult {
  std::size_t threads = 0;
  std::uint64_t messages = 0;      ///< sent
  double seconds = 0;              ///< from the first push to the last pop
  LatencyHistogram transit_ns;     ///< every 16th message, from the push that took it to its pop
  LatencyHistogram round_trip_ns;  ///< ping_pong, circulation: from the push until the message is back
  std::uint64_t push_calls = 0, push_refusals = 0;
  std::uint64_t pop_calls = 0, pop_refusals = 0;
  double blocked_seconds = 0;   ///< producers' time between a refusal and the next success, summed
  double producer_seconds = 0;  ///< producers' time, summed
  double fairness =
      1;  ///< least over most messages sent by a producer, at the time when the first one had sent its share
  std::size_t memory_bytes = 0;  ///< memory of one queue that has been full once, as far as the C library's heap tells
  Violations violations;
};

/// True if the queue serves as many producers and consumers as share one queue in the pattern.
bool pattern_fits(const QueueUnderTest& queue, Pattern pattern);

/// Runs the trial on threads of its own, which have ended when it returns. Only if a call of the queue itself never
/// returns are its threads left behind, and Violations::stuck is set.
TrialResult run_trial(const QueueUnderTest& queue, const TrialOptions& options);

}  // namespace carousel::ringbus::stress
