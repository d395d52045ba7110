#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/shading/open_rays.h"

namespace carousel::ringbus::cycle {

/// The workload as a source of camera rays. Keeps references to the workload and the count of open rays.
class CameraRays {
 public:
  CameraRays(Workload& workload, OpenRays& open) : workload_(workload), open_(open) {}

  /// Appends the next rays that a worker makes to `into`; returns how many there are.
  std::size_t take(RayBatch& into) {
    if (finished_ || dry_ || open_.room() == 0) return 0;
    const Workload::Generated answer = workload_.generate(WorkerId(0), open_.room(), into);
    first_hits_.insert(first_hits_.end(), answer.first_hits.begin(), answer.first_hits.end());
    finished_ = answer.finished;
    dry_ = answer.rays == 0;
    open_.begin_making(answer.rays);
    return answer.rays;
  }
  /// The rasterised samples that paths have read since the last call, also those of paths without rays.
  std::vector<DataRead> take_first_hits() { return std::exchange(first_hits_, {}); }
  /// Rays have been shaded, so that a workload that had none may have some again.
  void ask_again() { dry_ = false; }
  /// No further ray comes that no other ray causes.
  bool finished() const { return finished_; }

 private:
  Workload& workload_;
  OpenRays& open_;
  bool finished_ = false, dry_ = false;
  std::vector<DataRead> first_hits_;
};

}  // namespace carousel::ringbus::cycle
