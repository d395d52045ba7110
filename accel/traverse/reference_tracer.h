#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/workload.h"

namespace carousel::accel {

/// Closest hits (any hit for shadow rays) of the requests, depth-first over the whole structure, in order.
/// Appends one result a request. Rays must be valid (accel/traverse/ray_check.h).
void trace_depth_first(const Accel& accel, const RayBatch& rays, HitBatch& out, IntersectionCounts& counts);

/// As trace_depth_first(), with several rays under way at a time (accel/traverse/kernels.h, trace_interleaved), as the
/// ring traces treelets.
void trace_depth_first_interleaved(const Accel& accel, const RayBatch& rays, HitBatch& out, IntersectionCounts& counts);

struct ReferenceRun {
  std::size_t rays = 0;
  IntersectionCounts tests;
};

/// Runs a whole workload on the depth-first tracer, as worker 0, `batch` rays at a time: the answer every
/// engine must reproduce to the bit.
ReferenceRun run_reference(const Accel& accel, Workload& workload, std::size_t batch = 4096);

/// Runs the workload as run_reference() does, divided among `pieces`, with several rays under way at a time. `piece_of`
/// tells the piece of a ray that has not been shaded yet.
std::vector<ReferenceRun> run_reference_by_piece(const Accel& accel, Workload& workload, std::size_t pieces,
                                                 const std::function<std::size_t(const RayTag&)>& piece_of,
                                                 std::size_t batch = 4096);

}  // namespace carousel::accel
