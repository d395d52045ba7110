#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/config/config.h"
#include "ringbus/results/memory_request.h"
#include "ringbus/results/run_result.h"
#include "ringbus/verdict/foretell.h"

namespace carousel::ringbus {

// The values of a whole frame, estimated from a run over some of its paths, which were drawn over all of it.

/// The use of the parts of one class, as a fraction of the frame's time.
struct ClassEstimate {
  std::string_view name;  ///< as in CycleResult::uses
  Estimate use;
};

/// Values of a frame with intervals of confidence of 95 %. The values of a frame that was run whole are exact.
struct FrameValues {
  Estimate rays, cycles, cycles_per_ray, rays_per_kilocycle;
  Estimate box_tests_per_ray, triangle_tests_per_ray, memory_bytes_per_ray, link_bytes_per_ray;
  std::vector<ClassEstimate> uses;  ///< estimates for the classes that did anything
  double steady = 1;                ///< part of the rays that were completed between fill and drain
  bool too_small = false;           ///< the run is mostly fill and drain, so that the intervals are wide
};

/// A run over a part of a frame.
struct SampleRun {
  const RunResult& result;
  const MemoryLog& memory;        ///< all requests of the run
  std::uint64_t shape_bytes = 0;  ///< bytes of the acceleration structure, which stands at the beginning of the memory
  std::uint64_t paths = 0, frame_paths = 0;
  /// Paths and rays of each place, in the order in which they began.
  std::vector<std::uint64_t> paths_of, rays_of;
};

/// The values of a run of the whole frame.
FrameValues exact_values(const Config& config, const RunResult& result);

/// The sample's fill and drain happen once in the frame, too. So its cycles T are extrapolated by the rate between
/// them, m cycles a ray: frame = T + (frame's rays - sample's rays) m.
/// - The rays that are completed between fill and drain are cheaper than others, or dearer: m is the time there over
///   the part of the sample's box and triangle tests that was done there, over the sample's rays. Packets and waits
///   depend on which rays meet in the machine; tests hardly do.
/// - Caches are cold. The first request of a cache for a line of shapes is one of the frame's, too, and there are no
///   more of them than lines (frame_lines.h). Other requests for shapes come again since a line has been replaced; they
///   become more frequent as the caches fill, and are taken to be as many a ray as in the later half between fill and
///   drain. Where lines are replaced already, other requests increase by a part of the decrease in first requests. The
///   interval's upper end adds all of that part, as far as the frame's lines are more than the caches hold. Requests
///   for data of rays and paths are as many a ray as in the sample.
///   First lines cause a part of the time that testers waited: the part that the latency of the memory for them has of
///   all latencies, those of the caches' hits included. The rest of the frame waits less by as many as it has fewer of
///   them a ray. Half of the time that it so spares is added to the interval.
/// - Errors are those of the differences between neighbouring places and between neighbouring blocks of completed rays
///   (foretell.h), less the part of the frame that was simulated (K. Wolter, Introduction to Variance Estimation, 2nd
///   edition 2007, sections 1.4 and 8.2). As samples are drawn so that their tests are the frame's (app, RenderJob),
///   the error of the time is that of what the tests leave unexplained. The lower end is lower by the fraction by which
///   the resource with most tests has more than the mean: others may have waited for it, and in the frame do so less.
FrameValues estimate_frame(const Config& config, const SampleRun& run);

}  // namespace carousel::ringbus
