#pragma once

#include <vector>

#include "core/config/fields/topology.h"
#include "ringbus/topology/plan.h"

namespace carousel::ringbus {

// Parts that several shapes have in common.

/// Successors of a round through all resources in steps of `step`, which must have no divisor in common with their
/// number. A step of `resources - 1` goes backwards.
std::vector<ResourceId> round_in_steps(const TopologyConfig& config, std::int64_t step);

/// A plan of rings: a wire for each step of each round, round after round from the first resource on, with the flow
/// control's rule against deadlock. Acknowledgements of synthetic traffic go on round the ring of their packets.
TopologyPlan plan_of_rounds(const TopologyConfig& config, std::vector<std::vector<ResourceId>> successors);

/// Packets that a resource may have under way in each direction, for every shape whose packets go round.
std::uint32_t packets_in_flight(const TopologyConfig& config);

/// The verdict on a ring of links under the configured flow control; `flow: none` on other shapes as well.
DeadlockVerdict verdict_of_flow(const TopologyConfig& config);

}  // namespace carousel::ringbus
