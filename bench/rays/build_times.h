#pragma once

#include <vector>

#include "bench/common/results.h"
#include "bench/rays/contestants.h"
#include "core/config/config.h"

namespace carousel::bench {

/// Build times of Carousel and of Embree (medium and high quality, not robust), interleaved, for each number of
/// threads. A structure that takes more than a few seconds is built once only.
std::vector<BuildResult> build_times(const scene::Scene& scene, const BvhConfig& bvh, const Field& field,
                                     const std::vector<int>& threads, int repetitions);

/// Seconds from the loaded scene to the first packet: the build on `threads` threads, then a ring of as many
/// resources created until it generates its first rays. The median of the repetitions.
double to_first_packet(const scene::Scene& scene, const BvhConfig& bvh, const RingSettings& ring, int threads,
                       int repetitions);

}  // namespace carousel::bench
