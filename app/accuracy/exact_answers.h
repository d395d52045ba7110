#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "accel/traverse/exact_reference.h"
#include "core/types/workload.h"
#include "report/accuracy/accuracy.h"

namespace carousel::app {

using HitList = std::vector<Hit>;

/// Answers of the depth-first tracer, in the order of the rays.
HitList trace(const accel::Accel& accel, const RayBatch& rays);

/// Exact answers by each ray's flags, in the order of the rays, on all cores. A shadow ray's is its first hit.
std::vector<accel::ExactHit> exact_answers(const accel::ExactReference& reference, const RayBatch& rays);

/// Traces rays with other answers than the exact ones again, on `accel`, in which ExactOpacity answers any-hit calls:
/// whatever differs then is geometry. Puts the new answers into `hits`, and returns how many are new.
std::uint64_t settle_opacity(const accel::Accel& accel, const RayBatch& rays, const std::vector<accel::ExactHit>& exact,
                             HitList& hits);

/// The errors of `hits`. For shadow rays only occlusion counts.
report::HitErrors compare(const RayBatch& rays, const HitList& hits, const std::vector<accel::ExactHit>& exact);

}  // namespace carousel::app
