#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "ringbus/verdict/cycle_noise.h"
#include "ringbus/verdict/pilot_runs.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::ringbus {

/// The effect of one what-if on the frame's time.
struct Gain {
  std::string name, action;
  std::vector<std::string> sets;  ///< assignments of the what-if, as values of --set
  double rays_per_kilocycle = 0;  ///< throughput of the whole frame, foretold
  double gain = 0;                ///< over the machine as configured, as a fraction of its throughput
  double low = 0, high = 0;       ///< its interval of confidence
  /// Classes that were relaxed together in the simulation, and gained so little that none was looked at alone, or for
  /// which the budget had nothing left; 0: none was simulated, as the part has so much to spare.
  std::size_t together = 1;
  double frame = 0;  ///< part of the run's cycles from its start by which the gain is known; 0: by the pilot
};

/// A stretch of the pilot, by completed rays, and the class that gains most when it is relaxed there.
struct GainPhase {
  double begin = 0, end = 0;  ///< completed rays, as fractions of the pilot's
  double time = 0;            ///< part of the pilot's cycles
  std::string name, action;   ///< empty: none gains enough
  double gain = 0;
};

/// The bottleneck of a machine, found by simulating it with each class relaxed in turn.
struct Bottleneck {
  bool complete = true;           ///< false: interrupted; there are no gains
  std::string unlike;             ///< why no gain is told of a pilot that differs from the run; empty if gains are told
  double rays_per_kilocycle = 0;  ///< throughput of the machine as configured, over the whole frame
  std::uint64_t paths = 0;        ///< paths of the pilot
  std::uint64_t rays = 0;         ///< rays of the pilot, simulated for each class
  std::uint64_t simulated = 0;    ///< rays of all simulations of the search
  double taken = 0;               ///< what they took, as a part of the run
  bool whole = false;             ///< the pilot is the whole frame
  std::uint64_t least_paths = 0;  ///< if not 0: the frame is too small for a search, and so many paths would do
  double deviation = 0;           ///< distance of the run's cycles from those that the pilot foretells, as a fraction
  double uncertainty = 0;         ///< uncertainty of the foretold cycles, from the pilot alone, as a fraction
  std::optional<CycleNoise> noise;  ///< of the run's cycles; absent if a resource stops
  std::uint64_t noise_paths = 0;    ///< paths of each simulation that it was found with
  std::vector<Gain> gains;          ///< greatest first
  std::vector<Untried> untried;     ///< classes of which no gain is told
  std::vector<GainPhase> phases;    ///< of the first pilot, in the order of time; one if nothing changes
};

/// Simulates the machine and each relaxed one on the same pilot, on the cycle engine, and foretells their times for the
/// frame (foretell.h). A resource that stops is left out of account.
///
/// Of some draws of a pilot that one is taken by which the machine as configured is most like the run. A class whose
/// gain the run's ledger bounds below what is worth naming is not simulated (search_choices.h). The others are
/// simulated for a small pilot: those that stand alone, and then, as far as they may gain what another one surely does,
/// groups of those that the run kept busy for less than half of its time, or that others wait for. A group that may
/// gain enough is divided, unless the pilot is not like the run and may not tell its gain from nothing. If it is sure
/// then which class to name, the search ends. Else those that may be the best race over the frame (frame_race.h), which
/// the run itself is compared with (frame_beginning.h). Where the rest would be unlike the beginning a larger pilot is
/// simulated for them instead. A pilot that is not like the run tells of no class, unless one is worth naming in spite
/// of the difference, which widens the intervals, or by the frame's beginning. No simulation begins beyond the budget
/// (pilot_runs.h), and a frame that is too small for it is not searched. Where a resource stops there is no run to
/// compare with, and the pilot is larger.
///
/// The machine as configured is simulated with run.noise_seeds other seeds, for the noise of the run's cycles, by a
/// pilot as large as the budget allows; not where a resource stops.
///
/// As many simulations run at once as options.threads; `make_pilot` and its workloads are then called by several
/// threads at once, each workload by one. The answer does not depend on that. Throws as run_cycle.
Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const PilotFactory& make_pilot, const SearchedRun& run, const RunOptions& options,
                           const SearchObserver& observe = {});

/// The paths of a larger frame that a search fits, about: two digits, rounded up. The parts of the machine are taken to
/// be as busy there as in the run.
std::uint64_t least_paths_to_search(const Config& config, const accel::Accel& accel, const SearchedRun& run);

}  // namespace carousel::ringbus
