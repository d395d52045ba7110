#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/shading/open_rays.h"

namespace carousel::ringbus::cycle {

/// The workload as the source of camera rays for a pool of workers. Keeps references to all that it is given.
class CameraRays {
 public:
  /// All pools know this of the workload.
  struct Source {
    bool finished = false;  ///< no further ray comes that no other ray causes
    bool dry = false;       ///< there is none before a ray has been shaded
  };
  CameraRays(Workload& workload, OpenRays& open, Source& source) : workload_(workload), open_(open), source_(source) {}

  /// Appends the next rays that a worker makes to `into`; returns how many there are.
  std::size_t take(RayBatch& into) {
    if (source_.finished || source_.dry || open_.room() == 0) return 0;
    const Workload::Generated answer = workload_.generate(WorkerId(0), open_.room(), into);
    first_hits_.insert(first_hits_.end(), answer.first_hits.begin(), answer.first_hits.end());
    source_ = {answer.finished, answer.rays == 0};
    open_.begin_making(answer.rays);
    return answer.rays;
  }
  /// The rasterised samples that paths have read since the last call, also those of paths without rays.
  std::vector<DataRead> take_first_hits() { return std::exchange(first_hits_, {}); }
  /// Rays have been shaded, so that a workload that had none may have some again.
  void ask_again() { source_.dry = false; }
  /// No further ray comes that no other ray causes.
  bool finished() const { return source_.finished; }

 private:
  Workload& workload_;
  OpenRays& open_;
  Source& source_;
  std::vector<DataRead> first_hits_;
};

}  // namespace carousel::ringbus::cycle
