#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ringbus/results/slice_log.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// Names the clock that std::chrono::steady_clock reads in this process: the same text means the same clock. Empty
/// where the host does not tell.
std::string clock_identity();

/// The time by which each rank's clock is ahead of rank 0's, by rank. Ranks with rank 0's `identity` have its clock;
/// the others are asked for their time, several times, and the fastest answer counts: its time lies between those of
/// the question and of its receipt (D. L. Mills, RFC 5905, section 8; F. Cristian, "Probabilistic clock
/// synchronization", Distributed Computing 3, 1989). `now` is this rank's clock in nanoseconds.
///
/// Every rank calls, when no message is under way; they wait for one another. Throws a SimulationError that names a
/// rank which does not answer.
std::vector<RankClock> compare_clocks(Transport& transport, const std::string& identity,
                                      const std::function<std::int64_t()>& now);

}  // namespace carousel::ringbus
