#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/shading/shade_helpers.h"
#include "ringbus/cycle/shading/shade_queues.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Ray control and the pool of shader workers. A worker takes the ray that has waited longest in its queue, and needs
/// shading.cycles_per_shade for it, as for making a camera ray, and cycles_per_effect for each effect besides; what
/// resources ask about opacity comes first, and takes shading.cycles_per_any_hit each. What the workers have no hand
/// free for goes to resources that have nothing to test, with `idle_resources_shade`. New rays gather until they fill a
/// packet, or until no worker has anything to do, and are then given slots; with bundles they gather until they would
/// fill those that the builder holds open, and go through it `builder.rays_per_cycle` a cycle. A record of 64 bytes
/// needs its owner's load port for as many link widths as it has.
///
/// Of a resource that has stopped it hears the last sign of life (which stands for regular ones, whose wires carry
/// nothing else). So many cycles later it orders all resources to discard their work. Meanwhile what has come back is
/// shaded and what that gives is gathered; when all resources are drained, the rays that have not come back are placed
/// again.
class ShadingAgent final : public Agent {
 public:
  /// `clients` by resource.
  ShadingAgent(CycleMachine& machine, Workload& workload, TraceWindow window, std::vector<SidePorts> clients);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  std::string describe() const override;

  bool done() const { return source_finished_ && outstanding_ == 0; }
  /// Since the start, for the progress bar; from the agent's thread.
  std::uint64_t emitted() const { return emitted_; }
  std::uint64_t completed() const { return completed_; }
  /// Worker-cycles spent on shading and on making camera rays.
  Cycle busy() const { return busy_; }
  /// When each ray was shaded, in steps of so many rays; for the rate between fill and drain.
  struct Milestone {
    Cycle at = 0;
    std::uint64_t completed = 0;
  };
  const std::vector<Milestone>& milestones() const { return milestones_; }
  const Trace& trace() const { return trace_; }
  /// What became of a resource that stopped; absent if none was heard to.
  const std::optional<StopTimes>& stop() const { return stop_; }
  std::uint64_t rays_restarted() const { return rays_restarted_; }
  std::uint64_t paths_restarted() const { return paths_restarted_; }

 private:
  /// Of a resource.
  struct Question {
    std::uint32_t from;
    AnyHitQuestion rays;
  };
  /// What a worker is at.
  struct Job {
    Cycle done = 0;
    std::uint32_t worker = 0;
    std::size_t made = 0;  // camera rays; 0: it shades `ray`, or finds out what lets rays through
    RayResult ray;
    std::optional<Question> question{};
    bool operator>(const Job& o) const { return done != o.done ? done > o.done : worker > o.worker; }
  };

  void step(Cycle now);
  void take_completed(Cycle now);
  void take_questions(Cycle now);
  bool finish_jobs(Cycle now);
  bool start_jobs(Cycle now);
  Cycle cycles_for(const RayResult& ray) const;
  bool start_job(std::uint32_t worker, Cycle now);
  void place(Cycle now);
  void send_groups(Cycle now);
  void on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now);
  void give_up(Cycle now);
  void restart(Cycle now);
  void order_all(NewRays::Order order, Cycle now);
  std::size_t room() const;
  void milestone(Cycle now);

  CycleMachine& machine_;
  Workload& workload_;
  std::vector<SidePorts> clients_;
  Trace trace_;
  Cycle shade_cycles_, effect_cycles_, any_hit_cycles_, load_cycles_, latency_;
  std::size_t slots_, group_;
  std::size_t gather_;  // new rays that are worth giving slots
  Cycle builder_rate_, builder_free_ = 0;
  std::deque<Question> questions_;  // before any ray: they keep slots that could be free
  ShadeQueues queues_;
  ShadeHelpers helpers_;
  std::priority_queue<Job, std::vector<Job>, std::greater<>> jobs_;
  std::vector<std::uint32_t> idle_;  // workers, the next one last
  RayBatch gathered_;
  HitBatch shaded_;
  std::vector<RayGroup> groups_;
  std::vector<Cycle> load_free_, last_sent_;  // by resource
  bool source_finished_ = false, source_dry_ = false, started_ = false;
  std::size_t making_ = 0;
  std::unique_ptr<OutstandingRays> ledger_;  // where a resource may stop
  std::optional<StopTimes> stop_;
  Cycle give_up_at_ = kNever;
  std::size_t draining_ = 0;  // resources that have not said that they are drained
  std::uint64_t rays_restarted_ = 0, paths_restarted_ = 0;
  std::uint64_t outstanding_ = 0, emitted_ = 0, completed_ = 0;
  Cycle now_ = 0, busy_ = 0;
  std::uint64_t milestone_rays_ = 64;
  std::vector<Milestone> milestones_;
};

}  // namespace carousel::ringbus::cycle
