#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/types/workload.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/results/run_result.h"
#include "ringbus/verdict/frame_beginning.h"
#include "ringbus/verdict/small_frame.h"

namespace carousel::ringbus {

/// The run whose bottleneck is searched for.
struct SearchedRun {
  const RunResult& result;
  std::uint64_t paths = 0;                  ///< paths, or rays of a list, that the frame begins
  const cycle::CacheLines* warm = nullptr;  ///< that its caches held at its start; null: they were cold
  std::uint64_t noise_seeds = 0;  ///< other seeds of the picture to find the noise of its cycles with; 0: no noise
};

/// The ray slots of a machine.
std::uint64_t slots_of(const Config& config);

/// How large a pilot is at least: so that half of it is between fill and drain, or, where that takes too much, a third.
enum class PilotSize : std::uint8_t { kFull, kLeast };

/// Paths of a pilot that is to have `wanted` rays, for a frame of `paths` paths with `rays` rays; at most all of them.
std::uint64_t pilot_paths(const Config& config, std::uint64_t paths, std::uint64_t rays, std::uint64_t wanted,
                          PilotSize least);

// These bound what a search simulates, as parts of the run's rays, or of its cycles where it simulates the frame's
// beginning. A pilot's ray takes about as long as one of the run. A pilot's paths stand for as many rays as the run's;
// where they have more, the search takes more.
inline constexpr double kScreening = 0.33;  ///< that the first pilot is to take
inline constexpr double kScreened = 0.6;    ///< beyond which no group is divided that gains less than a class alone
inline constexpr double kWithNoise = 0.7;   ///< that all are to take, where a larger pilot tells the noise
inline constexpr double kWanted = 0.85;     ///< that all are to take
inline constexpr double kAtMost = 1.2;  ///< that the first pilot takes at most, and beyond which no group is divided
inline constexpr double kWithFrame = 1.75;  ///< that all take at most

struct SearchBudget {
  std::uint64_t paths = 0, rays = 0;  ///< of the run

  /// Rays of each of so many simulations that take this part of the run's together.
  std::uint64_t share(double part, std::size_t simulations) const {
    return static_cast<std::uint64_t>(std::max(0.0, part) * static_cast<double>(rays) /
                                      static_cast<double>(simulations));
  }
  /// The part of the run's rays that so many simulations of these paths take.
  double of(std::uint64_t pilot, std::size_t simulations) const {
    return static_cast<double>(simulations * pilot) / static_cast<double>(paths);
  }
};

/// The paths of a frame like that of the run in which the least pilots of so many machines keep within the budget: two
/// digits, rounded up.
inline std::uint64_t least_frame(const Config& config, const SearchedRun& run, std::size_t machines) {
  constexpr std::uint64_t kLarge = 1000;  // so that the frame of the run is no bound of its pilots
  const std::uint64_t pilot =
      pilot_paths(config, kLarge * run.paths, kLarge * run.result.rays_completed, 0, PilotSize::kLeast);
  return two_digits_up(static_cast<double>(machines * pilot) / kAtMost);
}

/// Paths of a search's pilot, which so many machines simulate and which is to take this part of the run: the least that
/// will do where more would take too much.
inline std::uint64_t first_paths(const Config& config, std::uint64_t paths, const SearchBudget& budget,
                                 std::size_t machines, double part) {
  constexpr double kMuch = 0.6;
  constexpr std::size_t kMore = 1;  // draws of the pilot, and parts of groups
  const std::uint64_t wanted = budget.share(part, machines + kMore),
                      full = pilot_paths(config, paths, budget.rays, wanted, PilotSize::kFull);
  return budget.of(full, machines) <= kMuch ? full : pilot_paths(config, paths, budget.rays, wanted, PilotSize::kLeast);
}

/// The machine with the picture's k-th other seed, of the same range, far from those that users count up from.
Config with_other_seed(const Config& machine, std::uint64_t k);

/// A pilot with the machine as configured.
struct BasePilot {
  std::uint64_t paths = 0, draw = 0;
  double cycles = 0;
};

/// Makes the workload of `paths` of the frame's paths, drawn over all of it, or of all of them; the same ones for each
/// machine, and others for another `draw`.
/// `more`: further paths that begin after those.
using PilotFactory = std::function<std::unique_ptr<Workload>(const Config&, std::uint64_t paths, std::uint64_t more,
                                                             std::uint64_t draw)>;

/// How far a search has come.
struct SearchProgress {
  std::string stage;             ///< the pilot
  std::size_t done = 0, of = 1;  ///< simulations of this stage
  std::uint64_t under_way = 0;   ///< rays that simulations under way have completed
  std::uint64_t rays = 0;        ///< that each will have, about
  std::uint64_t completed = 0;   ///< rays of all simulations of this stage
};
/// Called by one thread at a time, not always the same.
using SearchObserver = std::function<void(const SearchProgress&)>;

/// Simulates parts of a frame, its pilots, on machines of several configurations. Keeps references to its arguments.
class PilotRuns {
 public:
  /// `slots`: of the machine as configured.
  PilotRuns(const accel::Accel& accel, float scene_size, const PilotFactory& make_pilot, const SearchedRun& run,
            std::uint64_t slots, const RunOptions& options, const SearchObserver& observe)
      : accel_(accel),
        scene_size_(scene_size),
        make_pilot_(make_pilot),
        run_(run),
        slots_(slots),
        options_(options),
        observe_(observe) {}

  /// A pilot of so many paths, which this number of machines will get.
  void begin(const char* stage, std::size_t machines, std::uint64_t paths);
  /// The frame itself, of which one machine will get so many rays more.
  void begin_frame(std::uint64_t rays);
  /// A pilot is simulated to its end. One that then is hardly between fill and drain goes on with further paths, and
  /// ends when as many rays are completed as its own paths stand for.
  bool drains() const { return drains_; }
  /// Pilots are of this draw from now on.
  void take(std::uint64_t draw) { draw_ = draw; }
  void expect_more(std::size_t machines) { state_.of += machines; }
  void leave_out_one() { ++state_.done; }

  /// Simulates these machines, as many at once as there are threads: that takes less time than to simulate one after
  /// the other on all threads. The results are in the order of the machines, and undefined once complete() is false.
  /// Throws as run_cycle.
  std::vector<RunResult> simulate(const std::vector<const Config*>& machines);
  /// As simulate(), but the pilot alone, to its end.
  std::vector<RunResult> simulate_to_the_end(const std::vector<const Config*>& machines);
  /// The cycles that a machine took for the rays that the pilot's paths stand for.
  double cycles(const cycle::CycleResult& pilot) const;
  /// After begin_frame(): simulates the frame from its start on this machine, or goes on from where it had stopped,
  /// until it has completed the rays of the beginning, or all. Returns its progress and, at the end, its cycles.
  /// `machine` must outlive this object. Undefined once complete() is false. Throws as run_cycle.
  cycle::CycleResult go_on(const Config& machine, const FrameBeginning& beginning);

  /// False if a simulation was interrupted; no further one is begun.
  bool complete() const { return complete_; }
  /// Rays that all simulations so far have completed.
  std::uint64_t simulated_rays() const { return simulated_rays_; }
  /// What all simulations so far took, as a part of the run.
  double taken() const { return taken_; }

 private:
  /// A simulation, and what it works on.
  struct Simulation {
    std::unique_ptr<Workload> workload;
    RunOptions options;
    std::uint64_t shown = 0;  // completed rays that the observer knows of
    double taken = 0;         // part of the run
    std::unique_ptr<CycleSimulation> run;
  };
  void prepare(Simulation& simulation, const Config& machine, std::size_t threads);
  RunResult simulate(const Config& machine, std::size_t threads);

  const accel::Accel& accel_;
  float scene_size_;
  const PilotFactory& make_pilot_;
  const SearchedRun& run_;
  std::uint64_t slots_;
  const RunOptions& options_;
  const SearchObserver& observe_;
  static constexpr std::uint64_t kAllRays = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t paths_ = 0, rays_ = kAllRays, draw_ = 0;  // rays_: that the paths stand for
  std::mutex mutex_;                                      // guards the members below, and the observer
  SearchProgress state_;
  bool complete_ = true, drains_ = true;
  std::map<const Config*, Simulation> of_frame_;
  std::uint64_t simulated_rays_ = 0;
  double taken_ = 0;
};

/// The cycles that a pilot of `paths` takes with the seed of `first` and with `seeds` others. Its places in the picture
/// stay, and their rays change. The cycles of `first` are known and not simulated again. The result is undefined once
/// pilots.complete() is false. Throws as run_cycle.
std::vector<double> cycles_of_seeds(PilotRuns& pilots, const Config& machine, std::uint64_t seeds,
                                    const BasePilot& first, std::uint64_t paths);

}  // namespace carousel::ringbus
