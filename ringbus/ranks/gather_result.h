#pragma once

#include "ringbus/rays/rank_share.h"
#include "ringbus/results/run_result.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// Joins what the ranks of a run have counted: each knows its own resources, its ends of links and the rays that it has
/// shaded. Every rank calls, and every one gets the whole. Series of the links of other ranks are left behind, since
/// their clocks are not ours.
void gather_result(Transport& transport, const RankShare& share, RunResult& result);

}  // namespace carousel::ringbus
