#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/shading/camera_rays.h"
#include "ringbus/cycle/shading/shade_costs.h"
#include "ringbus/cycle/shading/shade_queues.h"
#include "ringbus/cycle/shading/shade_sorter.h"
#include "ringbus/cycle/shading/shading_recorder.h"
#include "ringbus/cycle/shading/shading_settings.h"

namespace carousel::ringbus::cycle {

/// The pool of shader workers, and what waits for them.
///
/// A worker answers any-hit calls first, because their rays keep slots that could be free. Otherwise it takes the rays
/// that have waited longest in its queue, as many as it has lanes. If no ray waits it makes camera rays.
/// Keeps references to all that it is given.
class ShadeWorkers {
 public:
  ShadeWorkers(const ShadingSettings& settings, const std::vector<SidePorts>& clients, Workload& workload,
               CameraRays& camera, ShadingRecorder& recorder);

  /// The next end of a job, any-hit call, or ray out of the sorter.
  Cycle next() const;
  /// A completed ray is to be shaded.
  void add(const RayResult& ray, Cycle now);
  /// Takes any-hit calls, and rays that have passed the sorter.
  void take_arrivals(Cycle now);
  /// Ends the jobs that are done, in the order of their ends. Appends the rays that have been shaded to `shaded`, calls
  /// `on_made(rays, began)` for camera rays, and answers any-hit calls. Returns false if no job has ended.
  template <class OnMade>
  bool finish(Cycle now, HitBatch& shaded, OnMade&& on_made) {
    const bool any = !ends_.empty() && ends_.top().done <= now;
    for (; !ends_.empty() && ends_.top().done <= now; ends_.pop()) {
      Job& job = end_job(ends_.top());
      if (job.call) {
        answer(job, now);
      } else if (job.made.empty()) {
        shaded.insert(shaded.end(), job.vector.rays.begin(), job.vector.rays.end());
      } else {
        on_made(job.made, job.began);
        job.made.clear();
      }
    }
    return any;
  }
  /// Gives idle workers work; returns false if none got any.
  bool start(Cycle now);
  /// The first ray of the longest queue and the cycles that it takes, for a resource that helps.
  std::optional<std::pair<RayResult, Cycle>> take_for_helper(Cycle now);

  /// Rays that wait for a worker.
  std::size_t waiting() const { return queues_.size() + (sorter_ ? sorter_->size() : 0); }
  std::size_t working() const { return jobs_.size() - idle_.size(); }
  /// Worker-cycles spent on jobs that are done: shading, camera rays and any-hit calls.
  Cycle busy() const { return busy_; }
  const ShadeCosts& costs() const { return costs_; }

 private:
  /// Any-hit calls of a resource.
  struct Call {
    std::uint32_t from;
    AnyHitQuestion rays;
  };
  /// The present work of a worker: any-hit calls, or camera rays if there are any in `made`, or else `vector`.
  struct Job {
    Cycle began = 0;
    RayBatch made;
    ShadeVector vector;
    std::optional<Call> call{};
  };
  /// The end of a job. Of jobs that end at one time that of the first worker goes first.
  struct JobEnd {
    Cycle done = 0;
    std::uint32_t worker = 0;
    bool operator>(const JobEnd& o) const { return done != o.done ? done > o.done : worker > o.worker; }
  };

  bool start_job(std::uint32_t worker, Cycle now);
  Job& end_job(JobEnd end);
  void answer(Job& job, Cycle now);

  const std::vector<SidePorts>& clients_;
  Workload& workload_;
  CameraRays& camera_;
  ShadingRecorder& recorder_;
  ShadeCosts costs_;
  bool by_shader_;                       // workers take vectors, so that a ray's shader matters
  std::unique_ptr<ShadeSorter> sorter_;  // with `shading.sort: shader`
  ShadeQueues queues_;
  std::deque<Call> calls_;
  std::vector<SideWire> answer_wires_;  // by resource
  std::vector<Job> jobs_;               // by worker
  std::priority_queue<JobEnd, std::vector<JobEnd>, std::greater<>> ends_;
  std::vector<std::uint32_t> idle_;  // workers, the next one last
  Cycle busy_ = 0;
};

}  // namespace carousel::ringbus::cycle
