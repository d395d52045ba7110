#pragma once

#include <vector>

#include "ringbus/results/slice_log.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// Joins the timelines of all ranks at rank 0, on rank 0's clock. The timelines of other ranks were noted from the same
/// moment on, by clocks that were so far ahead of rank 0's at the beginning (`first`) and at the end (`last`) of the
/// run, and are taken to have drifted evenly between. Tracks without slices are left out. Every rank calls, when no
/// message is under way; the others keep theirs.
void gather_timeline(Transport& transport, const std::vector<RankClock>& first, const std::vector<RankClock>& last,
                     Timeline& timeline);

}  // namespace carousel::ringbus
