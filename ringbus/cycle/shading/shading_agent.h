#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <queue>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/log2_histogram.h"
#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/shading/ray_data.h"
#include "ringbus/cycle/shading/shade_helpers.h"
#include "ringbus/cycle/shading/shade_queues.h"
#include "ringbus/cycle/shading/shade_sorter.h"
#include "ringbus/cycle/shading/shading_samples.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Ray control and the pool of shader workers.
///
/// A worker takes the rays that have waited longest in its queue, as many as it has lanes. It needs
/// shading.cycles_per_shade for a ray, and the time of the effects of its surface besides; lanes with one shader run
/// side by side, different shaders one after the other. If no ray waits it makes camera rays, at most as many as fill a
/// packet or the free slots, in cycles_per_shade for each vector of those that the workload still has. Any-hit calls of
/// resources come first and take shading.cycles_per_any_hit a vector. With `idle_resources_shade`, rays for which no
/// worker is free go to resources that have nothing to test.
///
/// New rays gather until they fill a packet, or until no worker has anything to do, and are then given slots. With
/// bundles they gather until they would fill the bundles that the builder holds open, and pass the builder
/// `builder.rays_per_cycle` a cycle. A record of 64 bytes needs its owner's load port for as many link widths as it
/// has.
///
/// A resource that stops sends a last beat, which stands for the regular ones of its wires. `silence_cycles` later the
/// agent orders all resources to discard their work. Rays that come back meanwhile are shaded, and the rays they cause
/// are gathered. When all resources are drained, the rays that have not come back are placed again.
class ShadingAgent final : public Agent {
 public:
  /// Keeps references to the machine and the workload. `clients` by resource.
  ShadingAgent(Machine& machine, const ShadingSettings& settings, Workload& workload, const Observation& observed,
               std::vector<SidePorts> clients);

  /// From now on data of rays and paths is in memory.
  void keep_in_memory(std::unique_ptr<RayData> data) { data_ = std::move(data); }
  /// Null if there is none.
  const RayData* ray_data() const { return data_.get(); }

  Cycle next() const override;
  bool polled() const override { return false; }
  void hear(Cycle at) override { next_completed_ = std::min(next_completed_, at); }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  /// No further ray comes that no other ray causes.
  bool all_begun() const { return source_finished_; }
  bool done() const { return source_finished_ && outstanding_ == 0 && making_ == 0; }
  /// Since the start, for the progress bar; from the agent's thread.
  std::uint64_t emitted() const { return emitted_; }
  std::uint64_t completed() const { return completed_; }
  /// The last cycle in which it did anything.
  Cycle last_event() const { return now_; }
  /// Worker-cycles spent on jobs that are done: shading, camera rays and any-hit calls.
  Cycle busy() const { return busy_; }
  /// The work of shading beyond that of plain surfaces, of all rays that began to be shaded.
  std::uint64_t products() const { return products_; }
  std::uint64_t lookups() const { return lookups_; }
  /// The vectors that the workers shaded.
  const ShadeVectorCounts& vectors() const { return vectors_; }
  /// How long rays were in slots, from being given one until their hit came to shading.
  const Log2Histogram& residence() const { return residence_; }
  const Trace& trace() const { return trace_; }
  /// Its counters over time (shading_samples.h), after close().
  const CounterSamples& samples() const { return samples_; }
  void close(Cycle end);
  /// From now on the life of a ray is noted.
  void record(const Recording& recording) { recording_ = recording; }
  /// The times at which a resource stopped and work began anew; absent if no stop was noted.
  const std::optional<StopTimes>& stop() const { return stop_; }
  std::uint64_t rays_restarted() const { return rays_restarted_; }
  std::uint64_t paths_restarted() const { return paths_restarted_; }

 private:
  /// Any-hit calls of a resource.
  struct Question {
    std::uint32_t from;
    AnyHitQuestion rays;
  };
  /// The present work of a shader worker.
  struct Job {
    Cycle began = 0;
    std::size_t made = 0;  // camera rays, in made_; 0: it shades `vector`, or answers `question`
    ShadeVector vector;
    std::optional<Question> question{};
  };
  /// The end of a job. Among jobs that end at one time that of the first worker goes first.
  struct JobEnd {
    Cycle done = 0;
    std::uint32_t worker = 0;
    bool operator>(const JobEnd& o) const { return done != o.done ? done > o.done : worker > o.worker; }
  };

  /// Completed rays of a resource that arrive in the present window.
  struct Due {
    Cycle at = 0;
    std::uint32_t from = 0;
    bool operator>(const Due& o) const { return at != o.at ? at > o.at : from > o.from; }
  };

  Cycle next_but_completed() const;
  void look_for(std::uint32_t client);
  void step(Cycle now);
  void sample(Cycle now);
  // With a recording (shading_record.cpp).
  void note_made(std::span<const RayRequest> rays, Cycle at, Cycle end);
  void note_taken(const HitBatch& rays, Cycle now);
  void note_shaded(Cycle now);
  void note_placed(RayId id, std::uint32_t home, Cycle now);
  void note_arrival(std::span<const RayId> ids, Cycle arrival);
  void read(Cycle at, std::span<std::uint64_t> row) const;
  void take_completed(Cycle now);
  void take_questions(Cycle now);
  bool finish_jobs(Cycle now);
  bool start_jobs(Cycle now);
  Cycle cycles_for(const RayResult& ray);
  Cycle cycles_for(const ShadeVector& vector);
  void to_be_shaded(const RayResult& ray, Cycle now);
  bool start_job(std::uint32_t worker, Cycle now);
  /// Takes the next camera rays from the workload, for a worker to make; returns how many there are.
  std::size_t take_camera_rays(std::uint32_t worker);
  void place(Cycle now);
  void send_groups(Cycle now);
  void place_group(std::uint32_t issuer, const RayGroup& group, Cycle now);
  void send_group(std::uint32_t issuer, RayGroup&& group, Cycle now);
  void take_ray_data(Cycle now);
  // Where rays travel to find slots (shading_travel.cpp).
  void gather_travellers();
  void add_traveller(std::uint32_t issuer, const RayGroup& group);
  void send_travellers(Cycle now);
  bool reserve_slots(const RayGroup& group);
  void on_note(std::uint32_t resource, CompletedRays::Note note, Cycle now);
  void give_up(Cycle now);
  void restart(Cycle now);
  void order_all(NewRays::Order order, Cycle now);
  std::size_t room() const;
  /// Rays that wait for a worker.
  std::size_t to_shade() const { return queues_.size() + (sorter_ ? sorter_->size() : 0); }

  Machine& machine_;
  FaultsConfig::Resource fault_;
  Workload& workload_;
  std::vector<SidePorts> clients_;
  Trace trace_;
  Cycle shade_cycles_, lookup_cycles_;
  std::uint64_t products_per_cycle_;
  Cycle any_hit_cycles_, load_cycles_, latency_;
  std::size_t slots_, group_;
  std::size_t gather_;  // new rays that are given slots together
  bool bundled_;
  Cycle builder_rate_, builder_free_ = 0;
  std::deque<Question> questions_;  // go before any ray: their rays keep slots that could be free
  std::size_t lanes_;
  std::unique_ptr<ShadeSorter> sorter_;  // with `shading.sort: shader`
  ShadeQueues queues_;
  ShadeVectorCounts vectors_;
  ShadeHelpers helpers_;
  std::vector<Job> jobs_;  // by worker
  std::priority_queue<JobEnd, std::vector<JobEnd>, std::greater<>> ends_;
  std::vector<std::uint32_t> idle_;  // workers, the next one last
  RayBatch gathered_;
  std::vector<RayBatch> made_;  // by worker: the camera rays of its job
  HitBatch shaded_;
  std::vector<RayGroup> groups_;
  std::unique_ptr<RayData> data_;              // in memory
  HitBatch stated_;                            // scratch
  std::vector<RayData::Group> loaded_groups_;  // scratch
  std::vector<RayData::Place> places_;         // scratch
  bool rays_travel_;
  struct Traveller {
    std::uint32_t issuer = 0;
    RayGroup group;
    bool counted = false;  // as one that waits
  };
  std::deque<Traveller> travellers_;               // that wait for free slots
  std::vector<std::uint64_t> free_slots_;          // by resource that addresses name, or of all in the first place
  std::vector<Cycle> load_free_;                   // by resource
  std::vector<SideWire> id_wires_, answer_wires_;  // likewise
  bool source_finished_ = false, source_dry_ = false, started_ = false;
  std::size_t making_ = 0;
  std::unique_ptr<OutstandingRays> ledger_;  // where a resource may stop
  std::optional<StopTimes> stop_;
  Cycle give_up_at_ = kNever;
  std::size_t draining_ = 0;  // resources that have not noted that they are drained
  std::uint64_t rays_restarted_ = 0, paths_restarted_ = 0;
  std::uint64_t outstanding_ = 0, emitted_ = 0, completed_ = 0;
  Cycle now_ = 0, busy_ = 0;
  std::uint64_t products_ = 0, lookups_ = 0;
  Recording recording_;
  Cycle shade_began_ = 0;  // when the shading of the followed ray began
  CounterSamples samples_;
  LevelSum waiting_, working_;                 // over time
  std::vector<Level> held_;                    // by resource: slots in use
  std::vector<std::vector<Cycle>> placed_at_;  // by resource and slot of a ray
  Log2Histogram residence_;
  Cycle next_ = 0;  // next(), at the end of the last run()
  std::priority_queue<Due, std::vector<Due>, std::greater<>> due_;
  Cycle window_end_ = 0, next_completed_ = kNever;  // completed rays that arrive after the window, as far as known
};

}  // namespace carousel::ringbus::cycle
