#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/faults/outstanding_rays.h"
#include "ringbus/native/native_machine.h"
#include "ringbus/native/native_port.h"
#include "ringbus/native/native_recorder.h"
#include "ringbus/native/native_router.h"
#include "ringbus/native/native_series.h"
#include "ringbus/native/shader_worker.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// The machine of a native run with the ports and shader workers that its threads step, shared out over the threads.
class NativeParts {
 public:
  using Ports = NativeSeries::Ports;

  /// Threads that can all have something to step, and at most RunOptions::threads.
  static std::size_t most_threads(const Config& config, const RunOptions& options);

  /// Builds the machine. Keeps references, but a copy of `own_links`.
  NativeParts(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
              const RunOptions& options, const LinkMaker& own_links, std::size_t threads);

  /// Makes the machine anew, with nothing in it, and its ports and workers. Counts of rays and of resources go on, and
  /// those that the machine keeps itself begin at 0.
  void build();

  /// The outcome of a step.
  struct Step {
    bool moved = false;  ///< something moved
    bool rests = false;  ///< a resource rests by request, which is no halt
  };
  /// Steps all that thread number `thread` plays.
  Step step(std::size_t thread);

  /// All rays have been shaded, and no packet is on its way. Any thread may call.
  bool at_rest() const { return count_.done() && packets_out() == 0; }
  /// Throws a SimulationError if something is left in the machine.
  void check_drained() const;
  /// Says of each port what it waits for, and of the way to other ranks, each on a line.
  std::string describe() const;
  /// Adds what has been counted here to the result.
  void add_to(RunResult& out) const;

  NativeMachine& machine() { return *machine_; }
  const NativeMachine& machine() const { return *machine_; }
  /// The way to other ranks; null if there are none.
  RankGate* gate() const { return machine_->gate.get(); }
  const Ports& ports() const { return ports_; }
  const RayCount& count() const { return count_; }
  /// The rays in the ring, where a resource may stop; otherwise null.
  const OutstandingRays* ledger() const { return ledger_.get(); }
  /// Null: nothing is recorded.
  NativeRecorder* recorder() const { return recorder_.get(); }

 private:
  std::uint64_t packets_out() const;

  const Config& config_;
  const accel::Accel& accel_;
  float scene_size_;
  Workload& workload_;
  const RunOptions& options_;
  const LinkMaker own_links_;  // empty: links as configured
  std::size_t threads_;
  std::size_t first_router_ = 0, first_worker_ = 0;  // the threads that play router 0 and worker 0
  std::unique_ptr<NativeMachine> machine_;
  RayCount count_;
  std::unique_ptr<OutstandingRays> ledger_;
  std::vector<std::unique_ptr<StatisticsSink>> sinks_;  // by resource; null without statistics
  Ports ports_;
  std::vector<std::unique_ptr<NativeRouter>> routers_;  // of a graph
  std::vector<std::unique_ptr<ShaderWorker>> workers_;
  std::unique_ptr<NativeRecorder> recorder_;
};

}  // namespace carousel::ringbus
