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
#include "ringbus/cycle/shading/programs/shade_cores.h"
#include "ringbus/cycle/shading/shade_costs.h"
#include "ringbus/cycle/shading/shade_queues.h"
#include "ringbus/cycle/shading/shade_sorter.h"
#include "ringbus/cycle/shading/shading_recorder.h"
#include "ringbus/cycle/shading/shading_settings.h"

namespace carousel::ringbus::cycle {

/// The pool of shader workers, and what waits for them.
///
/// A worker answers any-hit calls first, because their rays keep slots that could be free. Otherwise it takes the rays
/// that have waited longest in its queue, as many as it has lanes. If no ray waits it makes camera rays. Where workers
/// run programs a worker has a place for each vector that it holds, and the worker that holds fewest goes first. Paths
/// that begin at rasterised samples wait for these at their place; paths that end there wait for nothing.
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
    if (cores_) cores_->step(now, [&](std::uint32_t place) { ends_.push({now, place}); });
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
  std::size_t working() const { return cores_ ? cores_->working() : jobs_.size() - idle_.size(); }
  /// Worker-cycles in which a worker could do nothing else. They are those of jobs that are done: shading, camera rays
  /// and any-hit calls. With programs, which share a worker, they are those in which it issued, and of any-hit calls.
  Cycle busy() const { return cores_ ? cores_->issuing() : busy_; }
  /// The work of all rays that began to be shaded.
  ShadingCounts counts() const {
    ShadingCounts out = costs_.counts();
    out.busy = busy_;
    if (cores_) cores_->add_to(out);
    return out;
  }
  /// Where programs read; before the first step.
  void read_through(ProgramMemory& memory) {
    memory_ = &memory;
    if (cores_) cores_->read_through(memory);
  }
  void answer(const ProgramRead& read, Cycle now);

 private:
  /// Any-hit calls of a resource.
  struct Call {
    std::uint32_t from;
    AnyHitQuestion rays;
  };
  /// The present work of a place: any-hit calls, or camera rays if there are any in `made`, or else `vector`.
  struct Job {
    Cycle began = 0;
    RayBatch made;
    ShadeVector vector;
    std::optional<Call> call{};
    std::size_t rays = 0;
    std::size_t reads = 0;  // of rasterised samples, for which camera rays wait
  };
  /// The end of a job. Of jobs that end at one time that of the first place goes first.
  struct JobEnd {
    Cycle done = 0;
    std::uint32_t place = 0;
    bool operator>(const JobEnd& o) const { return done != o.done ? done > o.done : place > o.place; }
  };

  std::uint32_t worker_of(std::uint32_t place) const {
    return cores_ ? static_cast<std::uint32_t>(place / cores_->vectors()) : place;
  }
  bool start_job(std::uint32_t place, Cycle now);
  void begin(std::uint32_t place, Cycle now);
  std::size_t read_first_hits(std::uint32_t place, Cycle now);
  void set_rays(std::uint32_t place, std::size_t rays);
  void order_idle();
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
  std::vector<std::uint32_t> callers_;  // resources that make such calls
  std::vector<SideWire> answer_wires_;  // by resource
  std::unique_ptr<ShadeCores> cores_;   // where workers run programs
  ProgramMemory* memory_ = nullptr;     // where data of rays is in memory
  std::vector<Job> jobs_;               // by place
  std::priority_queue<JobEnd, std::vector<JobEnd>, std::greater<>> ends_;
  std::vector<std::uint32_t> idle_;  // places, the next one last
  Cycle busy_ = 0;
};

}  // namespace carousel::ringbus::cycle
